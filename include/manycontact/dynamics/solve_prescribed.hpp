#pragma once
// Contacts that are asked for an acceleration of their own, as a support that moves gives it:
//
//     [ M  J^T     ] [  a ]   [ tau - h(q, v) ]
//     [ J  -delta I] [ -f ] = [  prescribed - a0  ]
//
// Without gravity and at v = 0 it is also what asks for velocities: a is v+, tau the momentum, -f the impulse.

#include "manycontact/dynamics/solve.hpp"

namespace manycontact {

/// As solve_tau. prescribed: rows of the active contacts, as Solution::f [m/s^2, rad/s^2]. The answer has neither
/// derivatives nor error bounds: differentiate, jvp, vjp, estimate_errors and refine_truth throw std::logic_error.
/// Throws std::invalid_argument unless sizes fit.
[[nodiscard]] const Report& solve_tau(const Scene& scene, const ConstVector& q, const ConstVector& v,
                                      const ConstVector& tau, const ConstVector& prescribed, SceneData& data);

}  // namespace manycontact
