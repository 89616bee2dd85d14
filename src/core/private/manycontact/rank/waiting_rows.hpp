#pragma once
// Rows of J that wait. A row without a sound pivot in K's order is not eliminated, and joins the other rows, K1, by its
// Schur complement
//
//     K = [K1 B; B^T 0]        Z = K1^-1 B        -S = B^T Z >= 0
//
// Cholesky's factorization of -S takes the largest pivot first, relative to the terms of each row. A row that was only
// badly placed has a plain pivot there. What is left of a row that depends on the others is rounding.
// Source: Duff, Reid, ACM Trans. Math. Softw. 9 (1983), sec. 2, where pivots are delayed; Golub, Van Loan, Matrix
// Computations, sec. 4.2.8, for the factorization.

#include <functional>
#include <span>
#include <vector>

#include "manycontact/sparse/ldl.hpp"

namespace manycontact::rank {

/// X <- (L D L^T)^-1 X for the first `cols` columns of a row-major panel with row stride ld; its rows are in K's order.
using SolvePanel = std::function<void(double* X, int ld, int cols)>;

/// Storage is kept between factorizations: nothing is allocated for as many rows as there were before.
struct WaitingRows {
  std::vector<int> rows;  // rows of K: the first `joined` of them join, the others depend on them and on K1's rows
  int joined = 0;
  std::vector<double> Z;      // n x joined, by rows, in K's order; zero in the rows that K1 is without
  std::vector<double> scale;  // 1 / sqrt(terms) of each row
  std::vector<double> L;      // Cholesky's factor of scale (-S) scale of the rows that join, by rows, as wide as `rows`
  std::vector<int> place;     // number of each row of K in `rows` before they were ordered, or -1

  // scratch
  std::vector<double> B, G, old_scale, largest;
  std::vector<int> same, order, old_rows;  // same: 0, 1, 2 ...
};

/// The waiting rows, `w.rows`, join; those that depend come last in `w.rows`. Lx, D: of K1, with infinite D in each row
/// that K1 is without. of_M: flags of K's rows. row_size: n, the sizes of J's rows (rank/row_size.hpp).
void join_waiting_rows(const sparse::UpperCsc& K, const sparse::LdlSymbolic& symbolic, const double* Kx,
                       std::span<const char> of_M, const double* row_size, const double* Lx, const double* D,
                       const SolvePanel& solve, WaitingRows& w);

/// The part of a solution that those rows have. X: a row-major panel of cols columns with row stride ld, row k of K
/// is row[k] of X; row nullptr: k itself. before: of the right-hand sides, it keeps w.G, which `after` uses up.
void before_solve(WaitingRows& w, const int* row, const double* X, int ld, int cols);
void after_solve(WaitingRows& w, const int* row, double* X, int ld, int cols);

}  // namespace manycontact::rank
