#pragma once
// What pivots of L D L^T say about the factor.

#include <algorithm>
#include <cmath>

#include "manycontact/kkt/factor/factor.hpp"
#include "manycontact/sparse/tolerances.hpp"

namespace manycontact::internal {

/// Rows of J, damping 0: what a small pivot is wrong by is as much larger in those after it, where it may look like a
/// pivot of a row that has none. So of two pivots with the parts r and s left of them, r s must be above the rounding
/// of either. Of M's pivots alone, which small masses make small, nothing is told.
struct PassedOn {
  double least = 1, least_of_J = 1;  // parts left, so far
  /// Whether the next pivot may be that.
  bool next(bool of_M, double left) {
    const bool lost = left * (of_M ? least_of_J : least) < tolerance::kRowRounding;
    least = std::min(least, left);
    if (!of_M) least_of_J = std::min(least_of_J, left);
    return lost;
  }
};

/// K's inertia must be (nv, nc, 0), and no pivot lost in cancellation; nor M_kk beside what contact rows eliminated
/// before it add: such a row hardly moved the joints below it, so its pivot was rounding. ratio, scale:
/// sparse::smallest_pivot_ratio, and what it leaves.
inline Reason judge_pivots(const KktMatrix& K, const double* D, double ratio, const double* scale) {
  const sparse::UpperCsc& A = K.pattern->K;
  int positive = 0;
  bool lost = ratio < tolerance::kPivotLeft || (K.damping == 0 && K.nc() > K.nv());
  PassedOn passed_on;
  for (int k = 0; k < A.n; ++k) {
    if (!std::isfinite(D[k]) || D[k] == 0) return Reason::kZeroPivot;
    if (K.damping == 0 && passed_on.next(D[k] > 0, std::abs(D[k]) / scale[k])) lost = true;
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

/// What row k of J, in the island's order, is judged beside.
inline double size_of_row(const KktMatrix& K, const FactorScratch& scratch, int k) {
  return scratch.row_scale.size() == static_cast<std::size_t>(K.nc()) ? scratch.row_scale[k] : K.row_scale;
}

}  // namespace manycontact::internal
