#pragma once
#include <Eigen/SparseCore>

#include "manycontact/dynamics/data.hpp"
#include "manycontact/dynamics/derivatives.hpp"

namespace manycontact {

// clang-format off
/// Computes the derivatives of data.a and data.f at the last solve, using the factor of K = [M J^T; J -delta I]:
///
///     K [ da ; -df ] = -[ dr1 ; dr2 ],   r1 = ID(q, v, a, f) - tau,   r2 = J a + a0 + delta f.
///
/// ID is inverse dynamics. In dr1, f is constant in each contact's own frame. The torque tau(q, v, u, w) is the sum of
/// motors, joint friction, external wrenches and springs. If contacts are redundant and the rank of J is locally
/// constant, dforces_* are the derivatives of the least-norm forces. If contacts are inconsistent, da_* are the
/// derivatives of the least-squares accelerations. Blocks are NaN for failed islands, and for islands whose derivatives
/// could not be computed accurately.
///
/// Sizes per island: nv rows (a) or nc rows (f); nv columns (q, v), nu columns (u), 6 columns per external wrench (w).
/// The views in the result remain valid until the next solve. Memory: (nv + nc)(2 nv + nu) numbers per island. Cost:
/// one solve with the factor per column; `jvp` and `vjp` compute products at the cost of a few solves. With the sparse
/// methods, a call does not allocate if the request and the active contacts are those of an earlier call, unless a
/// state needs a fallback. Thread-safe for distinct data.
///
/// Throws std::logic_error before the first solve, and if contacts were switched after the last solve. Throws
/// std::invalid_argument if the data belong to another scene.
// clang-format on
const DerivativeData& differentiate(const Scene& scene, SceneData& data, const DerivativeRequest& request = {});

/// The derivatives of the whole scene, in the order of its v, u and of data.f. Matrices that were not requested have no
/// columns.
struct SceneDerivatives {
  Eigen::MatrixXd da_dq, da_dv, da_du, dforces_dq, dforces_dv, dforces_du;
  Eigen::MatrixXd da_dw, dforces_dw;  // derivatives with respect to all external wrenches, 6 columns each
};
/// Copies the blocks of the last `differentiate` into dense matrices of the whole scene, with nv and nc rows. They take
/// O((nv + nc)(2 nv + nu)) memory; for large scenes use sparse_derivatives or the blocks instead.
/// Throws std::logic_error unless differentiate was called after the last solve.
[[nodiscard]] SceneDerivatives dense_derivatives(const Scene& scene, const SceneData& data);

/// Copies the blocks of the last `differentiate` into one sparse column-major matrix with rows [a; f] and columns
/// [q | v | u | w]. Columns that were not requested are absent. Throws as dense_derivatives does.
[[nodiscard]] Eigen::SparseMatrix<double> sparse_derivatives(const Scene& scene, const SceneData& data);

/// Bounds of the largest errors of the derivatives of an island. Each bound is relative to the largest entry of its
/// matrix. It is 0 if the matrix is empty, NaN if it was not requested, above 1 if all entries may be rounding errors,
/// and infinite if no bound is known.
struct DerivativeBounds {
  double da_dq = 0, da_dv = 0, da_du = 0, dforces_dq = 0, dforces_dv = 0, dforces_du = 0;
  double da_dw = 0, dforces_dw = 0;
};
/// Bounds the errors of the last `differentiate`, one result per island, from the residual of K [da; -df] = -[dr1; dr2]
/// and a few solves with the factor:
///
///     |error| <= |K^-1| (|residual| + c eps (|terms of dr| + |K| |[da; -df]|) + e |terms of dr/dq|),
///
/// where c eps is a relative rounding error and e the relative error of a and f, in the maximum norm and to first
/// order. If rows are dependent, the bound also includes |K^+ K^+| times the uncertainty of the rows' inconsistency,
/// with K^+ the generalised inverse of K. The bound is infinite for failed islands and for deep trees whose K is too
/// large. Throws std::logic_error unless differentiate was called after the last solve.
[[nodiscard]] std::vector<DerivativeBounds> estimate_derivative_errors(const Scene& scene, SceneData& data);

/// Returns the result of the last `differentiate`. The reference remains valid as long as the data. Throws
/// std::logic_error if the data have no derivatives of their current solution.
const DerivativeData& derivatives(const SceneData& data);
/// Frees the memory of the derivatives, except the workspace of the threads. The next `differentiate` allocates again.
void release_derivatives(SceneData& data);

}  // namespace manycontact
