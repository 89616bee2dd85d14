#pragma once
// Panels for factors that take columns in K's order of elimination.

#include "manycontact/kkt/factor/factor.hpp"

namespace manycontact::internal {

/// B (n x cols, by columns) <- rows of the panel, in order of elimination; and back.
inline void take_columns(const KktPattern& p, const double* X, int ld, int first, int cols, std::vector<double>& B) {
  const std::size_t n = p.size();
  B.resize(std::max(B.size(), n * cols));
  for (std::size_t k = 0; k < n; ++k) {
    const double* row = X + static_cast<std::ptrdiff_t>(p.perm[k]) * ld + first;
    for (int c = 0; c < cols; ++c) B[c * n + k] = row[c];
  }
}
inline void put_columns(const KktPattern& p, const std::vector<double>& B, double* X, int ld, int first, int cols) {
  const std::size_t n = p.size();
  for (std::size_t k = 0; k < n; ++k) {
    double* row = X + static_cast<std::ptrdiff_t>(p.perm[k]) * ld + first;
    for (int c = 0; c < cols; ++c) row[c] = B[c * n + k];
  }
}

}  // namespace manycontact::internal
