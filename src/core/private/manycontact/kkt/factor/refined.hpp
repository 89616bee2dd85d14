#pragma once

#include "manycontact/kkt/factor/factor.hpp"
#include "manycontact/sparse/refine.hpp"

namespace manycontact {

namespace internal {

/// Adds v.null_component, the inconsistent part that a solve removed from b, to v.b and v.r, and updates v.scale.
void put_back_contradiction(const Factor& factor, const KktMatrix& K, KktVectors& v);

}  // namespace internal

struct PanelWork {
  std::vector<double> B;  // right-hand sides, overwritten
  std::vector<double> R;  // residuals, if the caller checks them
  std::vector<double> sums;
  std::vector<char> nonzero;  // scratch: at least one flag per row of K
  KktVectors column;
};

/// Refines X += K^-1 (B - K X), B = work.B, until residuals are rounding errors, in all ld columns of the panel X, rows
/// in the island's order. Returns the largest residual relative to |K|_1 |X| + |B|.
double refine_panel(Factor& factor, const KktMatrix& K, double* X, int ld, PanelWork& work);

}  // namespace manycontact
