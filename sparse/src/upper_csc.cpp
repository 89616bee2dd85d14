#include "manycontact/sparse/upper_csc.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

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
  std::sort(entries.begin(), entries.end(), [](const auto& a, const auto& b) {
    return a.second != b.second ? a.second < b.second : a.first < b.first;
  });
  entries.erase(std::unique(entries.begin(), entries.end()), entries.end());
  UpperCsc A;
  A.n = n;
  A.p.assign(n + 1, 0);
  for (const auto& [row, col] : entries) {
    A.i.push_back(row);
    ++A.p[col + 1];
  }
  for (int j = 0; j < n; ++j) A.p[j + 1] += A.p[j];
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
