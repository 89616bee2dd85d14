#include "manycontact/sparse/upper_csc.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "manycontact/sparse/panel_kernels.hpp"

namespace manycontact::sparse {

int UpperCsc::slot(int row, int col) const {
  const auto begin = i.begin() + p[col], end = i.begin() + p[col + 1];
  const auto it = std::lower_bound(begin, end, row);
  return it != end && *it == row ? static_cast<int>(it - i.begin()) : -1;
}

UpperCsc make_pattern(int n, std::vector<std::pair<int, int>> entries) {
  for (auto& [row, col] : entries)
    if (row > col) std::swap(row, col);
  for (int k = 0; k < n; ++k) entries.emplace_back(k, k);
  // Counting sort by row, then by column: the rows of each column are then in ascending order.
  std::vector<int> begin(n + 1, 0);
  for (const auto& entry : entries) ++begin[entry.first + 1];
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  std::vector<int> column(entries.size()), row(entries.size()), at(begin.begin(), begin.end() - 1);
  for (const auto& entry : entries) column[at[entry.first]++] = entry.second;
  UpperCsc A;
  A.n = n;
  A.p.assign(n + 1, 0);
  for (int j : column) ++A.p[j + 1];
  std::partial_sum(A.p.begin(), A.p.end(), A.p.begin());
  at.assign(A.p.begin(), A.p.end() - 1);
  for (int i = 0; i < n; ++i)
    for (int k = begin[i]; k < begin[i + 1]; ++k) row[at[column[k]]++] = i;
  int count = 0;  // number of entries without repetitions
  for (int j = 0, from = 0; j < n; ++j) {
    const int end = A.p[j + 1], first = count;
    for (; from < end; ++from)
      if (count == first || row[count - 1] != row[from]) row[count++] = row[from];
    A.p[j + 1] = count;
  }
  A.i.assign(row.begin(), row.begin() + count);
  return A;
}

UpperCsc permute(const UpperCsc& A, const std::vector<int>& iperm) {
  std::vector<std::pair<int, int>> entries;
  entries.reserve(A.i.size());
  for (int j = 0; j < A.n; ++j)
    for (int k = A.p[j]; k < A.p[j + 1]; ++k) entries.emplace_back(iperm[A.i[k]], iperm[j]);
  return make_pattern(A.n, std::move(entries));
}

void residual(const UpperCsc& A, const double* Ax, const double* x, const double* b, double* r, double* scale) {
  panel_kernels().residual_vector(A, Ax, x, b, r, scale);
}

void residual_panel(const UpperCsc& A, const double* Ax, const int* row, const double* X, double* B, int ld, int cols) {
  panel_kernels().residual(A, Ax, row, X, B, ld, cols);
}

double norm_1(const UpperCsc& A, const double* Ax, double* work) {
  std::fill(work, work + A.n, 0.0);
  for (int j = 0; j < A.n; ++j)
    for (int k = A.p[j]; k < A.p[j + 1]; ++k) {
      work[j] += std::abs(Ax[k]);
      if (A.i[k] != j) work[A.i[k]] += std::abs(Ax[k]);
    }
  return A.n ? *std::max_element(work, work + A.n) : 0.0;
}

}  // namespace manycontact::sparse
