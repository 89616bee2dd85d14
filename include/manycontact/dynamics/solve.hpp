#pragma once
#include "manycontact/dynamics/data.hpp"

namespace manycontact {

using ConstVector = Eigen::Ref<const Eigen::VectorXd>;

/// Contact forward dynamics: accelerations data.a and contact forces data.f of the scene at q (nq), v (nv), u (nu, the
/// torques of the actuated coordinates), by
///
///     [ M  J^T     ] [  a ]   [ S^T u + J_F^T w + tau_s(q, v) - h ]
///     [ J  -delta I] [ -f ] = [              -a0                  ]
///
/// (w: wrenches data.pushes at frames F of the scene's pushes; tau_s: its springs and the friction of joints)
/// per island, with data.options.method. Returns data.report, whose status says what the answer is worth; a failed
/// island's a and f are NaN. Allocates nothing when every island's trees and contacts were met before, gains and frames
/// too, by the sparse methods but sparse-supernodal. Bits do not depend on what data held before.
/// Throws std::invalid_argument when a size does not fit the scene or data are not of this scene, and leaves what is at
/// hand; std::bad_alloc, and std::invalid_argument for data.active of another length: no answer is at hand then
/// (data.serial is 0), and the next call starts anew.
[[nodiscard]] const Report& solve(const Scene& scene, const ConstVector& q, const ConstVector& v, const ConstVector& u,
                                  SceneData& data);

/// The same with torques tau (nv) on every velocity coordinate, floating bases included.
[[nodiscard]] const Report& solve_tau(const Scene& scene, const ConstVector& q, const ConstVector& v,
                                      const ConstVector& tau, SceneData& data);

/// The levels of instructions for robots in SIMD lanes that are compiled in and run on this processor, widest first.
std::vector<Lanes> lanes_here();

/// After solve: the 1-norm condition number of each island's K, estimated by a few solves with the factor at hand
/// (Hager, Higham), into the report. Of a singular K with dependent rows: |K|_1 |K^+|_1 of the generalised inverse
/// used.
void estimate_condition(const Scene& scene, SceneData& data);

/// After solve: bounds of the errors of each island's a and f, into the report, by a few solves with the factor at
/// hand:
///
///     |x - x_true| <= |K^-1| (|r| + c eps (|b| + |K||x| + what K and b were computed from))
///
/// in the maximum norm, to first order in eps; c grows with the depth of the trees. Failed islands: infinite. Of an
/// answer that rounding may change by more than its size, and by more than what acts (gravity, torques, bias
/// forces: a scene at rest accelerates by rounding, and that is known to be little), `ok` and `redundant` become
/// `regularised`, the answer to a neighbouring problem, with the reason kUncertain. Source: Higham, Accuracy and
/// Stability (2002), 7.2 and ch. 15.
void estimate_errors(const Scene& scene, SceneData& data);

}  // namespace manycontact
