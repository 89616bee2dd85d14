#pragma once
// The equations of contacts whose accelerations are prescribed, for example on a moving support, are
//
//     [ M  J^T     ] [  a ]   [ tau - h(q, v) ]
//     [ J  -delta I] [ -f ] = [  prescribed - a0  ]
//
// Without gravity and at v = 0 these equations also solve an impact: a is the velocity after the impact, tau the
// momentum before the impact, and f the impulse.

#include "manycontact/dynamics/solve.hpp"

namespace manycontact {

/// Solves with torques tau (scene.nv) [N m, N] and prescribed accelerations of the constraint rows (the size of
/// Solution::f) [m/s^2, rad/s^2]. q: scene.nq, v: scene.nv; units, frames, cost and lifetime are those of `solve`. The
/// solution has neither derivatives nor error bounds: differentiate, jvp, vjp and estimate_errors throw
/// std::logic_error. Throws std::invalid_argument unless all sizes fit. Thread-safe for distinct data.
[[nodiscard]] const Report& solve_tau(const Scene& scene, const ConstVectorRef& q, const ConstVectorRef& v,
                                      const ConstVectorRef& tau, const ConstVectorRef& prescribed, SceneData& data);

}  // namespace manycontact
