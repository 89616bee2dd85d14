#pragma once
// Any factor with iterative refinement on the true residual: x += K^-1 (b - K x).

#include "manycontact/kkt/factor/factor.hpp"
#include "manycontact/sparse/refine.hpp"

namespace manycontact {

namespace internal {

/// Adds the inconsistent part of v.b, which was removed because of redundant rows, to v.b and v.r again.
void put_back_contradiction(const Factor& factor, const KktMatrix& K, KktVectors& v);

}  // namespace internal

/// Memory for refining panels, row-major of K.size() rows.
struct PanelWork {
  std::vector<double> B;  // right-hand sides; used up
  std::vector<double> R;  // residuals, where they are judged
  std::vector<double> sums;
  std::vector<char> nonzero;  // a flag per row of K, at least
  KktVectors column;          // one of them
};

/// X <- X + K^-1 (B - K X) for a whole panel X with row stride ld, rows in the island's order, padding included, until
/// the largest residual of a column is rounding; that is returned, relative to |K|_1 |X| + |B|. work.B: B.
double refine_panel(Factor& factor, const KktMatrix& K, double* X, int ld, PanelWork& work);

}  // namespace manycontact
