#pragma once

#include <vector>

namespace manycontact::sparse {

/// The pattern of the upper triangle and diagonal. Column j has rows i[p[j]] ... i[p[j+1]-1], ascending, each <= j.
struct UpperCsc {
  int n = 0;
  std::vector<int> p{0};
  std::vector<int> i;

  int nonzeros() const { return static_cast<int>(i.size()); }
  int slot(int row, int col) const;  // position in `i` of entry (row, col), row <= col, or -1; for set-up only
};

/// Returns the pattern with the diagonal and the given entries (row, col), in any order and triangle, also repeated.
UpperCsc make_pattern(int n, std::vector<std::pair<int, int>> entries);

/// Returns the pattern of P A P^T, in which entry (i, j) of A moves to (iperm[i], iperm[j]).
UpperCsc permute(const UpperCsc& A, const std::vector<int>& iperm);

/// Computes r = b - A x, and scale[k] = |b_k| + sum_j |A_kj x_j|. x, b, r and scale have length n.
void residual(const UpperCsc& A, const double* Ax, const double* x, const double* b, double* r, double* scale);

/// B <- B - A X for row-major panels of `cols` columns with row stride ld; row k of A is row row[k] of X and B.
void residual_panel(const UpperCsc& A, const double* Ax, const int* row, const double* X, double* B, int ld, int cols);

double norm_1(const UpperCsc& A, const double* Ax, double* work);  // |A|_1 of the whole matrix; work: n numbers

}  // namespace manycontact::sparse
