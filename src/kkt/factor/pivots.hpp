#pragma once
// What pivots of L D L^T say about the factor.

#include <algorithm>
#include <cmath>

#include "manycontact/kkt/factor/factor.hpp"
#include "manycontact/sparse/tolerances.hpp"

namespace manycontact::internal {

/// K's inertia must be (nv, nc, 0), and no pivot lost in cancellation; nor M_kk beside what contact rows eliminated
/// before it add: such a row hardly moved the joints below it, so its pivot was rounding. ratio, scale:
/// sparse::smallest_pivot_ratio, and what it leaves.
inline Reason judge_pivots(const KktMatrix& K, const double* D, double ratio, const double* scale) {
  const sparse::UpperCsc& A = K.pattern->K;
  int positive = 0;
  bool lost = ratio < tolerance::kPivotLeft;
  for (int k = 0; k < A.n; ++k) {
    if (!std::isfinite(D[k]) || D[k] == 0) return Reason::kZeroPivot;
    if (!(D[k] > 0)) continue;
    ++positive;
    lost = lost || K.values[A.p[k + 1] - 1] < tolerance::kPivotLeft * scale[k];
  }
  if (positive != K.nv()) return Reason::kWrongInertia;
  return lost ? Reason::kSmallPivot : Reason::kNone;
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
