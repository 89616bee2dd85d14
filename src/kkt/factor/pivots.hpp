#pragma once
// What pivots of L D L^T say about the factor.

#include <algorithm>
#include <cmath>

#include "manycontact/kkt/factor/factor.hpp"
#include "manycontact/sparse/tolerances.hpp"

namespace manycontact::internal {

/// K's inertia must be (nv, nc, 0), and no pivot lost in cancellation. ratio: sparse::smallest_pivot_ratio.
inline Reason judge_pivots(const KktPattern& p, const double* D, double ratio) {
  int positive = 0;
  for (int k = 0; k < p.size(); ++k) {
    if (!std::isfinite(D[k]) || D[k] == 0) return Reason::kZeroPivot;
    positive += D[k] > 0;
  }
  if (positive != p.nv) return Reason::kWrongInertia;
  return ratio < tolerance::kPivotLeft ? Reason::kSmallPivot : Reason::kNone;
}

/// Of K's entries during elimination. scale: n terms of the pivots, as sparse::smallest_pivot_ratio leaves them.
inline double growth_of(const KktMatrix& K, const double* scale) {
  const sparse::UpperCsc& A = K.pattern->K;
  double terms = 0, diagonal = 0;
  for (int k = 0; k < A.n; ++k) {
    terms = std::max(terms, scale[k]);
    diagonal = std::max(diagonal, std::abs(K.values[A.p[k + 1] - 1]));
  }
  return diagonal > 0 ? terms / diagonal : 1;
}

}  // namespace manycontact::internal
