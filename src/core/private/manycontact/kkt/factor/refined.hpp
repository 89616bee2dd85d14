#pragma once
// Iterative refinement by the true residual with any factor of K: x += K^-1 (b - K x).

#include "manycontact/kkt/factor/factor.hpp"
#include "manycontact/sparse/refine.hpp"

namespace manycontact {

namespace internal {

/// Adds v.null_component, the inconsistent part that a solve with redundant rows removed from b, to v.b and v.r, and
/// updates v.scale.
void put_back_contradiction(const Factor& factor, const KktMatrix& K, KktVectors& v);

}  // namespace internal

/// Memory for the refinement of row-major panels with K.size() rows.
struct PanelWork {
  std::vector<double> B;  // right-hand sides, overwritten
  std::vector<double> R;  // residuals, if the caller checks them
  std::vector<double> sums;
  std::vector<char> nonzero;  // scratch: at least one flag per row of K
  KktVectors column;
};

/// Refines X += K^-1 (B - K X), with B = work.B, until each column's residual is a rounding error. X is a panel with
/// row stride ld, rows in the island's order; all ld columns are refined. Returns the largest residual relative to
/// |K|_1 |X| + |B|.
double refine_panel(Factor& factor, const KktMatrix& K, double* X, int ld, PanelWork& work);

}  // namespace manycontact
