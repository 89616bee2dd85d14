#pragma once
#include "manycontact/dynamics/data.hpp"

namespace manycontact {

using ConstVector = ConstVectorRef;  // the former name of ConstVectorRef

/// Contact forward dynamics: computes the accelerations data.a (nv) and the contact forces data.f of the scene. They
/// satisfy
///
///     [ M  J^T     ] [  a ]   [ S^T u + J_F^T w + tau_s(q, v) - h ]
///     [ J  -delta I] [ -f ] = [              -a0                  ]
///
/// island by island, with data.options.method. S selects the actuated coordinates, delta is Scene::damping, w are the
/// external wrenches `data.wrenches`, J_F is the Jacobian of their frames, and tau_s are the torques of springs and
/// joint friction.
///
/// `q`: configuration (scene.nq) [m, rad, unit quaternions]. `v`: velocity (scene.nv) [m/s, rad/s]; that of a floating
/// base is the spatial velocity in the base's own frame, linear part first. `u`: torques of the actuated coordinates
/// (scene.nu) [N m, N]. `data.f` is expressed in the reference frame of each contact [N, N m].
///
/// Returns data.report. Its status states whether the solution is exact, least-squares, approximate or missing. The
/// accelerations and forces of a failed island are NaN. The reference remains valid as long as `data`; the next solve
/// overwrites the report.
///
/// With the sparse methods a call does not allocate if `data` was used before with the same active contacts of each
/// island. The result is bitwise independent of the previous contents of `data`. The cost is linear in the number of
/// separate robots. Thread-safe for distinct `data`; `scene` is only read.
///
/// Throws std::invalid_argument if a size does not fit the scene or the data belong to another scene; the previous
/// solution is kept. Throws std::bad_alloc, and std::invalid_argument if data.active has a wrong size. In these two
/// cases there is no solution (data.serial is 0), and the next call sets up the islands again.
[[nodiscard]] const Report& solve(const Scene& scene, const ConstVectorRef& q, const ConstVectorRef& v,
                                  const ConstVectorRef& u, SceneData& data);

/// Solves with torques tau (scene.nv) [N m, N] on every velocity coordinate, those of floating bases included.
/// Everything else is as in `solve`.
[[nodiscard]] const Report& solve_tau(const Scene& scene, const ConstVectorRef& q, const ConstVectorRef& v,
                                      const ConstVectorRef& tau, SceneData& data);

/// Returns the SIMD instruction sets that are compiled in and supported by this processor, widest first.
std::vector<SimdLevel> available_simd_levels();

/// Estimates the 1-norm condition number of each island's K after a solve, and stores it in the report. The cost is a
/// few solves with the existing factor (Hager, Higham). If K is singular because rows are dependent, the number is
/// |K|_1 |K^+|_1, with K^+ the generalised inverse. Throws std::logic_error before a solve. Thread-safe for distinct
/// data.
void estimate_condition(const Scene& scene, SceneData& data);

/// Bounds the errors of each island's a and f after a solve, in the maximum norm, and stores the bounds in the report.
/// A copy of the solution is refined with residuals in double-double (Precision::kExtended). The bound is the distance
/// to the copy plus the copy's uncertainty. The uncertainty is the copy's last correction and, except in precision
/// `extended`, the rounding of the scene's numbers when they were read. The bound is usually less than a thousand times
/// the error. The cost is about ten solves. The copy may not converge, because rows are dependent only by rounding or
/// because of Scene::tolerance. The bound is then
///
///     |x - x_true| <= |K^-1| (|r| + c eps (|b| + |K||x| + terms of K and b))
///
/// to first order in eps, often a thousand times the error. The factor c grows with the depth of the trees. The bounds
/// of failed islands are infinite.
///
/// Rounding errors may change a solution by more than its size, and by more than gravity, torques and bias forces. Then
/// the status `ok` or `redundant` becomes `regularised`, with the reason kUncertain. A scene at rest keeps its status:
/// its accelerations are rounding errors, but are known to be small relative to gravity.
///
/// Throws std::logic_error before a solve. Thread-safe for distinct data. Source: Higham, Accuracy and Stability
/// (2002), 7.2 and ch. 15.
void estimate_errors(const Scene& scene, SceneData& data);

/// Computes how well the solution in `data` satisfies its equations (SystemQuality), one entry per island. The cost is
/// about ten solves with the existing factor, and a factorization if K was not formed. Throws std::logic_error before a
/// solve. Thread-safe for distinct data.
[[nodiscard]] std::vector<SystemQuality> system_quality(const Scene& scene, SceneData& data);

}  // namespace manycontact
