#pragma once
// What pivots of L D L^T say about the factor.

#include <algorithm>
#include <cmath>

#include "manycontact/kkt/factor/factor.hpp"
#include "manycontact/sparse/tolerances.hpp"

namespace manycontact::internal {

/// PassedOn (factor.hpp) along an elimination tree: what a pivot is wrong by reaches its ancestors, and no others.
class PassedOnInTree {
 public:
  PassedOnInTree(const sparse::LdlSymbolic& symbolic, FactorScratch& scratch)
      : symbolic_(symbolic), at_(scratch.passed_on) {
    at_.assign(symbolic.n, {});
  }
  bool next(int k, bool of_M, double left) {
    const bool lost = at_[k].next(of_M, left);
    pass_up(k);
    return lost;
  }
  /// Of a row without pivot in place of `next`.
  void pass_up(int k) {
    const int parent = symbolic_.parent[k];
    if (parent < 0) return;
    at_[parent].least = std::min(at_[parent].least, at_[k].least);
    at_[parent].least_of_J = std::min(at_[parent].least_of_J, at_[k].least_of_J);
  }

 private:
  const sparse::LdlSymbolic& symbolic_;
  std::vector<PassedOn>& at_;
};

/// Memory for any_pivot_is_rounding: taken by every factorization, since a later state may need it.
inline double* noise_of(int n, FactorScratch& scratch) {
  std::vector<double>& memory = scratch.ldl.Y;
  if (memory.size() < static_cast<std::size_t>(n)) memory.resize(n);
  return memory.data();
}

/// The same by L itself, sharper: a pivot is wrong by the rounding of its own terms and by l^2 times what the pivots
/// before it are, but among M's alone. Of a long tower each contact's pivots are small beside their terms, by the inertia
/// of all above, and hardly change those below. Whether some pivot is no more than that; of rows without pivot, whose D
/// is infinite, nothing is asked. scratch.scale: the pivots' terms.
template <class OfM>
bool any_pivot_is_rounding(const sparse::LdlSymbolic& s, const double* L, const double* D, double margin, OfM&& of_M,
                           FactorScratch& scratch) {
  double* noise = noise_of(s.n, scratch);
  std::fill_n(noise, s.n, 0.0);
  bool lost = false;
  for (int j = 0; j < s.n; ++j) {
    if (!std::isfinite(D[j])) continue;
    const double wrong = noise[j] += tolerance::kRowRounding * scratch.scale[j];
    lost = lost || !(std::abs(D[j]) > margin * wrong);
    for (int k = s.Lp[j]; k < s.Lp[j + 1]; ++k)
      if (!of_M(j) || !of_M(s.Li[k])) noise[s.Li[k]] += L[k] * L[k] * wrong;
  }
  return lost;
}

/// K's inertia must be (nv, nc, 0), and no pivot lost in cancellation; nor M_kk beside what contact rows eliminated
/// before it add: such a row hardly moved the joints below it, so its pivot was rounding. ratio, scratch.scale:
/// sparse::smallest_pivot_ratio, and what it leaves. L: where it is at hand; else nullptr.
inline Reason judge_pivots(const KktMatrix& K, const double* L, const double* D, double ratio, FactorScratch& scratch) {
  const std::vector<double>& scale = scratch.scale;
  const sparse::UpperCsc& A = K.pattern->K;
  int positive = 0;
  bool lost = ratio < tolerance::kPivotLeft || (K.damping == 0 && K.nc() > K.nv()), passed = false;
  PassedOnInTree passed_on(K.pattern->ldl, scratch);
  (void)noise_of(A.n, scratch);
  for (int k = 0; k < A.n; ++k) {
    if (!std::isfinite(D[k]) || D[k] == 0) return Reason::kZeroPivot;
    if (K.damping == 0 && passed_on.next(k, D[k] > 0, std::abs(D[k]) / scale[k])) passed = true;
    if (!(D[k] > 0)) continue;
    ++positive;
    lost = lost || K.values[A.p[k + 1] - 1] < tolerance::kPivotLeft * scale[k];
  }
  if (positive != K.nv()) return Reason::kWrongInertia;
  if (!lost && passed)
    lost = !L || any_pivot_is_rounding(K.pattern->ldl, L, D, 1, [D](int k) { return D[k] > 0; }, scratch);
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
