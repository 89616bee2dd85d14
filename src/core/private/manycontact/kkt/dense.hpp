#pragma once
// The dense reference solver: the KKT system of one island, rank-revealing, in any scalar. It solves where J has
// dependent rows (delta = 0) and where M alone is singular but the contacts constrain its null space:
//
//   a minimises (a - a_free)^T M (a - a_free) among the minimisers of |J a - b2|,
//   f is the least-norm solution of J^T f = M a - b1.
//
// Null-space method: J^T P = Q [C; 0], R C^T = U T V^T (complete orthogonal decomposition), a = J^+ b2 + N y, (N^T M N)
// y = N^T (b1 - M J^+ b2). A pivoted QR of J, rows relative to their sizes, decides the rank and puts independent rows
// first in P. R sorts rows by size, V pivots, so that least squares of micrometres and radians lose no digits. With
// delta > 0: LU of K. Sources: Golub, Van Loan, Matrix Computations (2013), 5.5 and 6.2; Cox, Higham, Stability of
// Householder QR factorization for weighted least squares problems (1998).

#include "manycontact/sparse/decompositions.hpp"
#include "manycontact/spatial/scalar.hpp"

namespace manycontact {

template <class S>
struct DenseKkt {  // K and its rank-revealing factor
  MatX<S> M, J;    // nv x nv, nc x nv
  S delta = S(0);
  VecX<S> row_scale;  // nc, sizes of rows of J (rank/row_size.hpp); empty: their largest entries

  // set by factor
  int rank = 0;          // rank of J
  bool holds = false;    // N^T M N is positive definite, for any delta: contacts constrain M's null space
  bool regular = false;  // also, with delta > 0, K's pivots are sound: a and f exist
  Eigen::ColPivHouseholderQR<MatX<S>> choice;       // factor of J^T, rows over their sizes: P, and residuals
  Eigen::HouseholderQR<MatX<S>> of_Jt;              // J^T P = Q [C; 0]
  Eigen::PermutationMatrix<Eigen::Dynamic> sorted;  // R P^T: rows of J in the order of R C^T
  Eigen::ColPivHouseholderQR<MatX<S>> of_Ct;        // R C^T = U T V^T
  MatX<S> N;                                        // nv x (nv - rank): orthonormal basis of J's null space
  Eigen::LLT<MatX<S>> reduced;                      // factor of N^T M N
  Eigen::PartialPivLU<MatX<S>> lu;                  // factor of K, if delta > 0

  int nv() const { return static_cast<int>(M.rows()); }
  int nc() const { return static_cast<int>(J.rows()); }

  /// Returns J^+ b, the least-norm a among those of least |J a - b|, per column of b (nc x k).
  MatX<S> motion(const MatX<S>& b) const;
  /// Returns (J^T)^+ g, the least-norm f among those of least |J^T f - g|, per column of g (nv x k).
  MatX<S> force(const MatX<S>& g) const;
};

/// Factorizes M, J and delta.
template <class S>
void factor(DenseKkt<S>& kkt);

/// Solves M a - J^T f = b1, J a + delta f = b2, as defined above, per column of b1 (nv x k), b2 (nc x k), with one
/// refinement on the true residual. If `regular` is false, a and f are NaN. A row of J is dependent if its part
/// orthogonal to the others is below tolerance::kRank of its size.
template <class S>
void solve(const DenseKkt<S>& kkt, const MatX<S>& b1, const MatX<S>& b2, MatX<S>& a, MatX<S>& f);

/// Returns K = [M J^T; J -delta I].
template <class S>
MatX<S> kkt_matrix(const DenseKkt<S>& kkt);

}  // namespace manycontact
