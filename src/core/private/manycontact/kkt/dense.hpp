#pragma once
// The dense reference solver solves the KKT system of one island in any scalar, with a rank-revealing factor. J may
// have dependent rows (delta = 0); M may be singular if contacts constrain its null space. a_free: a without contacts.
//
//   a minimises (a - a_free)^T M (a - a_free) among the minimisers of |J a - b2|,
//   f is the least-norm solution of J^T f = M a - b1.
//
// For delta = 0, N is a basis of J's null space, J^T P = Q [C; 0], R C^T = U T V^T (complete orthogonal decomposition),
// a = J^+ b2 + N y, (N^T M N) y = N^T (b1 - M J^+ b2). A pivoted QR of J^T, rows of J divided by their sizes, gives the
// rank and P, which puts independent rows first. R sorts rows by size and V pivots, so that micrometres and radians
// lose no digits. For delta > 0, K has an LU. Sources: Golub, Van Loan, Matrix Computations (2013), 5.5, 6.2; Cox,
// Higham, Stability of Householder QR factorization for weighted least squares problems (1998).

#include "manycontact/sparse/decompositions.hpp"
#include "manycontact/spatial/scalar.hpp"

namespace manycontact {

template <class S>
struct DenseKkt {  // M, J, delta of K, and the rank-revealing factor
  MatX<S> M, J;    // nv x nv, nc x nv
  S delta = S(0);
  VecX<S> row_scale;  // nc: sizes of rows of J (rank/row_size.hpp), or empty: a row's size is its largest entry

  // set by factor
  int rank = 0;          // rank of J
  bool holds = false;    // whether N^T M N is positive definite, i.e. contacts constrain M's null space
  bool regular = false;  // whether a and f exist: `holds`, and if delta > 0, K's pivots are sound
  Eigen::ColPivHouseholderQR<MatX<S>> choice;       // pivoted QR of J^T, each row of J divided by its size; gives P
  Eigen::HouseholderQR<MatX<S>> of_Jt;              // J^T P = Q [C; 0]
  Eigen::PermutationMatrix<Eigen::Dynamic> sorted;  // R P^T: the rows of J in the order of R C^T
  Eigen::ColPivHouseholderQR<MatX<S>> of_Ct;        // R C^T = U T V^T
  MatX<S> N;                                        // nv x (nv - rank): orthonormal basis of J's null space
  Eigen::LLT<MatX<S>> reduced;                      // factor of N^T M N
  Eigen::PartialPivLU<MatX<S>> lu;                  // factor of K; used if delta > 0

  int nv() const { return static_cast<int>(M.rows()); }
  int nc() const { return static_cast<int>(J.rows()); }

  MatX<S> motion(const MatX<S>& b) const;  // J^+ b: least |a| among minimisers of |J a - b|; b: nc x k
  MatX<S> force(const MatX<S>& g) const;   // (J^T)^+ g: least |f| among minimisers of |J^T f - g|; g: nv x k
};

template <class S>
void factor(DenseKkt<S>& kkt);

/// Solves M a - J^T f = b1, J a + delta f = b2 for each column, with one refinement on the true residual; a and f are
/// NaN unless `regular`. A row is dependent if its part orthogonal to independent rows is at most kRank of its size.
template <class S>
void solve(const DenseKkt<S>& kkt, const MatX<S>& b1, const MatX<S>& b2, MatX<S>& a, MatX<S>& f);

template <class S>
MatX<S> kkt_matrix(const DenseKkt<S>& kkt);

}  // namespace manycontact
