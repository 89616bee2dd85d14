#pragma once
// The dense reference solver: the KKT system of one island, rank-revealing, in any scalar. It solves where J has
// dependent rows (delta = 0) and where M alone is singular but the contacts constrain its null space:
//
//   a minimises (a - a_free)^T M (a - a_free) among the minimisers of |J a - b2|,
//   f is the least-norm solution of J^T f = M a - b1.
//
// Null-space method: J^T P = Q [C; 0], R C^T = U T V^T (a complete orthogonal decomposition), a = J^+ b2 + N y,
// (N^T M N) y = N^T (b1 - M J^+ b2). A QR with pivoting, with each row of J relative to its own size, decides which
// rows count, and come first in P: metres and radians, and moment arms of any length, do not. R sorts the rows by their
// sizes, V pivots: least squares of micrometres and radians lose no digits then. With delta > 0 the solution is unique:
// LU of K. Source: Golub, Van Loan, Matrix Computations (2013), 5.5 and 6.2; Cox, Higham, Stability of Householder QR
// factorization for weighted least squares problems (1998).

#include "manycontact/sparse/decompositions.hpp"
#include "manycontact/spatial/scalar.hpp"

namespace manycontact {

template <class S>
struct DenseKkt {  // K and its rank-revealing factor
  MatX<S> M, J;    // nv x nv, nc x nv
  S delta = S(0);
  VecX<S> row_scale;  // nc, sizes that rows of J are relative to (rank/row_size.hpp); empty: their largest entries

  // set by factor
  int rank = 0;          // rank of J
  bool holds = false;    // N^T M N is positive definite, whatever delta: contacts constrain M's null space
  bool regular = false;  // and, with delta > 0, K's pivots are sound: a and f can be had
  Eigen::ColPivHouseholderQR<MatX<S>> choice;       // factor of J^T, rows over their sizes: P, and what is left of each
  Eigen::HouseholderQR<MatX<S>> of_Jt;              // J^T P = Q [C; 0]
  Eigen::PermutationMatrix<Eigen::Dynamic> sorted;  // R P^T: rows of J in the order of R C^T
  Eigen::ColPivHouseholderQR<MatX<S>> of_Ct;        // R C^T = U T V^T
  MatX<S> N;                                        // nv x (nv - rank): orthonormal basis of J's null space
  Eigen::LLT<MatX<S>> reduced;                      // factor of N^T M N
  Eigen::PartialPivLU<MatX<S>> lu;                  // factor of K, if delta > 0

  int nv() const { return static_cast<int>(M.rows()); }
  int nc() const { return static_cast<int>(J.rows()); }

  /// J^+ b: of the a of least |J a - b| the least; one column of b (nc x k) each.
  MatX<S> motion(const MatX<S>& b) const;
  /// (J^T)^+ g: of the f with J^T f = g (nv x k), or nearest to it, the least.
  MatX<S> force(const MatX<S>& g) const;
};

/// Factorizes M, J, delta, which the caller has set.
template <class S>
void factor(DenseKkt<S>& kkt);

/// Solves M a - J^T f = b1, J a + delta f = b2, as defined above; one column of b1 (nv x k), b2 (nc x k) per system.
/// Refines once on the true residual. Where `regular` is false, a and f are NaN. A row of J counts as dependent when
/// its part orthogonal to the others is below tolerance::kRank of its size.
template <class S>
void solve(const DenseKkt<S>& kkt, const MatX<S>& b1, const MatX<S>& b2, MatX<S>& a, MatX<S>& f);

/// K itself, [M J^T; J -delta I].
template <class S>
MatX<S> kkt_matrix(const DenseKkt<S>& kkt);

}  // namespace manycontact
