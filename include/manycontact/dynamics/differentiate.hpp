#pragma once
#include <Eigen/SparseCore>

#include "manycontact/dynamics/data.hpp"
#include "manycontact/dynamics/derivatives.hpp"

namespace manycontact {

// clang-format off
/// Derivatives of data.a and data.f at the last solve, with its factor:
///
///     K [ da ; -df ] = -[ dr1 ; dr2 ],   r1 = ID(q, v, a, f) - tau,   r2 = J a + a0 + delta f,
///
/// f held constant in each contact's own frame while r1 is differentiated; tau(q, v, u, w) is that of motors, friction,
/// pushes and springs. Where contacts are redundant, dforces_* are
/// those of the least-norm forces, the rank being locally constant; where they contradict each other, da_* are those of
/// the least-squares accelerations. NaN are the blocks of failed islands, and of those whose system for them, worse than
/// that of the solve, was not solved to kConverged.
/// Allocates nothing after the first call with the same request and contact set, by the sparse methods, unless a state
/// needs another way (a thread's first derivatives take scratch that it keeps). Throws std::logic_error before the first
/// solve and when contacts were switched after it, std::invalid_argument when data are not of this scene.
// clang-format on
const DerivativeData& differentiate(const Scene& scene, SceneData& data, const DerivativeRequest& request = {});

/// The scene's matrices in the order of its v, u and of data.f: for callers that want one matrix. Blocks that were not
/// asked for come out with no columns. Throws std::logic_error unless differentiate was called after the last solve.
struct SceneDerivatives {
  Eigen::MatrixXd da_dq, da_dv, da_du, dforces_dq, dforces_dv, dforces_du;
  Eigen::MatrixXd da_dw, dforces_dw;  // by the wrenches of all pushes, 6 columns each
};
[[nodiscard]] SceneDerivatives dense_derivatives(const Scene& scene, const SceneData& data);  // nv, nc rows

/// The same as one sparse matrix, rows [a; f], columns [q | v | u | w] (those asked for), column-major.
[[nodiscard]] Eigen::SparseMatrix<double> sparse_derivatives(const Scene& scene, const SceneData& data);

/// Bounds of the largest errors of an island's derivatives, each relative to the largest entry of its matrix: 0 where
/// that was not asked for or is empty, above 1 where all of it is rounding, infinite where there is no bound.
struct DerivativeBounds {
  double da_dq = 0, da_dv = 0, da_du = 0, dforces_dq = 0, dforces_dv = 0, dforces_du = 0;
  double da_dw = 0, dforces_dw = 0;
};
/// After differentiate, one per island, by the residual of K [da; -df] = -[dr1; dr2] and a few solves with the factor:
///
///     |error| <= |K^-1| (|residual| + c eps (|terms of dr| + |K| |[da; -df]|) + e |terms of dr/dq|),
///
/// e the relative error of a and f, in the maximum norm and to first order; where rows depend, |K^+ K^+| times what is
/// not known of their contradictions besides. Infinite for failed islands and deep trees too large for K. Throws
/// std::logic_error unless differentiate was called after the last solve.
[[nodiscard]] std::vector<DerivativeBounds> estimate_derivative_errors(const Scene& scene, SceneData& data);

/// What differentiate computed last.
const DerivativeData& derivatives(const SceneData& data);
/// Gives back the memory of derivatives, which the next differentiate takes again (but not the threads' scratch).
void release_derivatives(SceneData& data);

}  // namespace manycontact
