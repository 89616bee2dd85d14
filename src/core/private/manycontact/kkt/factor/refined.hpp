#pragma once
// Iterative refinement by the true residual with any factor of K: x += K^-1 (b - K x).

#include "manycontact/kkt/factor/factor.hpp"
#include "manycontact/sparse/refine.hpp"

namespace manycontact {

namespace internal {

/// Adds the inconsistent part of b, which a solve with redundant rows removed, to v.b and v.r again.
void put_back_contradiction(const Factor& factor, const KktMatrix& K, KktVectors& v);

}  // namespace internal

/// Memory for refining row-major panels of K.size() rows.
struct PanelWork {
  std::vector<double> B;  // right-hand sides, overwritten
  std::vector<double> R;  // residuals, if the caller checks them
  std::vector<double> sums;
  std::vector<char> nonzero;  // scratch: at least one flag per row of K
  KktVectors column;
};

/// Refines a panel X with row stride ld, rows in the island's order, padding included: X += K^-1 (B - K X), B = work.B,
/// until each column's residual is rounding error. Returns the largest residual relative to |K|_1 |X| + |B|.
double refine_panel(Factor& factor, const KktMatrix& K, double* X, int ld, PanelWork& work);

}  // namespace manycontact
