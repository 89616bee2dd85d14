#pragma once
// Waiting rows B^T of J have no sound pivot in K's order. They join the other rows, K1, by their Schur complement S
//
//     K = [K1 B; B^T 0]        Z = K1^-1 B        -S = B^T Z >= 0
//
// A Cholesky factorization of -S takes the largest pivot first, relative to the terms of each row. A row that only came
// too early in K's order has a sound pivot there; a dependent row leaves only a rounding error. Sources: Duff, Reid,
// ACM Trans. Math. Softw. 9 (1983), sec. 2, for delayed pivots; Golub, Van Loan, Matrix Computations, sec. 4.2.8.

#include <functional>
#include <span>
#include <vector>

#include "manycontact/sparse/ldl.hpp"

namespace manycontact::rank {

/// X <- (L D L^T)^-1 X in the first `cols` columns of a row-major panel with row stride ld, rows in K's order.
using SolvePanel = std::function<void(double* X, int ld, int cols)>;

struct WaitingRows {      // allocates nothing for at most as many rows as before
  std::vector<int> rows;  // rows of K: the first `joined` rows are independent, the others are dependent
  int joined = 0;
  std::vector<double> Z;      // K1^-1 B (file header), n x joined, by rows, in K's order; zero in rows not in K1
  std::vector<double> scale;  // one entry per waiting row: 1 / sqrt(terms of its pivot)
  std::vector<double> L;      // Cholesky factor of scale (-S) scale, by rows, as wide as `rows`
  std::vector<int> place;     // one entry per row of K: its index in the original `rows`, or -1

  // scratch
  std::vector<double> B, G, old_scale, largest;
  std::vector<int> same, order, old_rows;  // same: the numbers 0, 1, 2 ...
};

/// Factorizes the Schur complement of the rows w.rows, and moves dependent ones to the end of w.rows. Lx, D: factor of
/// K1, with infinite D in rows not in K1. of_M: flags of K's rows. row_size: n sizes of J's rows (rank/row_size.hpp).
void join_waiting_rows(const sparse::UpperCsc& K, const sparse::LdlSymbolic& symbolic, const double* Kx,
                       std::span<const char> of_M, const double* row_size, const double* Lx, const double* D,
                       const SolvePanel& solve, WaitingRows& w);

/// Call before_solve with right-hand sides X, solve with K1, then call after_solve; w.G has the joined rows' solution
/// in between. X: row-major panel with row stride ld; row k of K is row row[k] of X, or row k if row is nullptr.
void before_solve(WaitingRows& w, const int* row, const double* X, int ld, int cols);
void after_solve(WaitingRows& w, const int* row, double* X, int ld, int cols);

}  // namespace manycontact::rank
