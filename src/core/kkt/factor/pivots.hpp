#pragma once

#include <algorithm>
#include <cmath>

#include "manycontact/kkt/factor/factor.hpp"
#include "manycontact/rank/pivots.hpp"

namespace manycontact::internal {

/// Checks that K has the signature (nv, nc, 0), and that pivots exceed their rounding errors. scratch.scale: magnitudes
/// of the pivots' terms. L: nullptr if unknown; more pivots are then rejected.
inline Reason judge_pivots(const KktMatrix& K, const double* L, const double* D, FactorScratch& scratch) {
  const std::vector<double>& terms = scratch.scale;
  const sparse::UpperCsc& A = K.pattern->K;
  const auto of_M = [&K](int k) { return K.pattern->of_M[k] != 0; };
  bool lost = K.damping == 0 && K.nc() > K.nv(), passed = false, signs = true;
  rank::PassedOnInTree passed_on(K.pattern->ldl, scratch.passed_on);
  std::vector<double>& noise = scratch.ldl.Y;  // sized now, as a later state may need it when nothing may be allocated
  if (std::ssize(noise) < A.n) noise.resize(A.n);
  for (int k = 0; k < A.n; ++k) {
    if (!std::isfinite(D[k]) || D[k] == 0) return Reason::kZeroPivot;
    const rank::Pivot<double> pivot{of_M(k), D[k], terms[k], std::max(K.values[A.p[k + 1] - 1], 0.0)};
    if (K.damping == 0 && !passed_on.accepts(k, pivot.of_M, std::abs(D[k]) / terms[k])) passed = true;
    signs = signs && rank::has_its_sign(pivot);
    lost = lost || !rank::is_left(pivot);
  }
  if (!signs) return Reason::kWrongInertia;
  if (!lost && passed)
    lost = !L || rank::any_pivot_is_rounding(K.pattern->ldl, L, D, terms.data(), 1, of_M, noise.data());
  return lost ? Reason::kSmallPivot : Reason::kNone;
}

/// Returns the growth of K's entries: the largest of the pivots' `terms` over the largest diagonal entry.
inline double growth_of(const KktMatrix& K, const double* terms) {
  const sparse::UpperCsc& A = K.pattern->K;
  double largest = 0, diagonal = 0;
  for (int k = 0; k < A.n; ++k) {
    largest = std::max(largest, terms[k]);
    diagonal = std::max(diagonal, std::abs(K.values[A.p[k + 1] - 1]));
  }
  return diagonal > 0 ? largest / diagonal : 1;
}

/// Returns the size relative to which row k of J is judged: scratch.row_scale[k] or, without it, K.row_scale.
inline double size_of_row(const KktMatrix& K, const FactorScratch& scratch, int k) {
  return scratch.row_scale.size() == static_cast<std::size_t>(K.nc()) ? scratch.row_scale[k] : K.row_scale;
}

}  // namespace manycontact::internal
