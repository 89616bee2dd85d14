#pragma once
// Whether pivots of L D L^T = K = [M J^T; J -delta I] exceed rounding errors. S has one value per robot of a batch.

#include <algorithm>
#include <cmath>
#include <vector>

#include "manycontact/sparse/ldl.hpp"
#include "manycontact/sparse/tolerances.hpp"
#include "manycontact/spatial/scalar.hpp"

namespace manycontact::rank {

/// Pivot k, and the sizes with which it is compared.
template <class S>
struct Pivot {
  bool of_M;
  S d, terms;          // d: pivot D_k; terms: |K_kk| + sum l_kj^2 |d_j|, its terms added as magnitudes
  S own;               // row of M: K_kk; row of J: its largest entry
  S row_size = S(-1);  // size of a row of J (rank/row_size.hpp); negative: `own` is not judged
};

/// Whether the pivot exceeds `margin` times its rounding error. For a row of M, M_kk must also exceed this error: if
/// the terms of rows of J are much larger than M_kk, these rows had no sound pivots. For a row of J, its largest entry
/// must exceed `margin` times its rounding error. False for infinite or NaN terms.
template <class S>
auto is_left(const Pivot<S>& p, double margin = 1) {
  const S least = S(margin * tolerance::kPivotLeft) * p.terms, size = absolute(p.d);
  const S own = p.of_M ? least : S(margin * tolerance::kRank) * p.row_size;
  return (size > least) & (p.own > own);
}
/// Whether the pivot is positive in a row of M, negative in a row of J, as all sound pivots of K are in any order.
template <class S>
auto has_its_sign(const Pivot<S>& p) {
  return p.of_M ? p.d > S(0) : p.d < S(0);
}

/// Rejects pivots that may be errors of earlier ones. At damping 0, elimination amplifies the error of a small pivot of
/// J in later rows. If two pivots are r and s relative to their terms, r s must exceed the rounding error, except for
/// two pivots of M, which small masses make small. Each pivot is compared with all earlier ones.
template <class S>
struct PassedOn {
  S least = S(1), least_of_J = S(1);        // least |d| / terms so far, of all pivots and of J's pivots
  auto accepts(bool of_M, const S& left) {  // left: the next pivot's |d| / terms
    const auto accepted = left * (of_M ? least_of_J : least) >= S(tolerance::kRowRounding);
    least = -larger(S(-left), S(-least));
    if (!of_M) least_of_J = -larger(S(-left), S(-least_of_J));
    return accepted;
  }
};

/// Judges pivots as PassedOn does, but only with pivots below in the elimination tree, whose errors alone reach them.
class PassedOnInTree {
 public:
  PassedOnInTree(const sparse::LdlSymbolic& symbolic, std::vector<PassedOn<double>>& memory)
      : symbolic_(symbolic), at_(memory) {
    at_.assign(static_cast<std::size_t>(symbolic.n), {});
  }
  bool accepts(int k, bool of_M, double left) {
    const bool accepted = at_[k].accepts(of_M, left);
    if (const int parent = symbolic_.parent[k]; parent >= 0) {
      at_[parent].least = std::min(at_[parent].least, at_[k].least);
      at_[parent].least_of_J = std::min(at_[parent].least_of_J, at_[k].least_of_J);
    }
    return accepted;
  }

 private:
  const sparse::LdlSymbolic& symbolic_;
  std::vector<PassedOn<double>>& at_;
};

/// Whether some pivot is only a rounding error, with sharper bounds than PassedOn's: a pivot's error is its terms'
/// rounding error plus l^2 times errors of earlier pivots, except between pivots of M. (In tall towers, small pivots of
/// contacts hardly affect those below.) Rows without a pivot have D infinite, L zero. noise: scratch, n.
template <class OfM>
bool any_pivot_is_rounding(const sparse::LdlSymbolic& s, const double* L, const double* D, const double* terms,
                           double margin, OfM&& of_M, double* noise) {
  std::fill_n(noise, s.n, 0.0);
  for (int j = 0; j < s.n; ++j) {
    const double wrong = noise[j] += tolerance::kRowRounding * terms[j];
    if (!(std::abs(D[j]) > margin * wrong)) return true;
    for (int k = s.Lp[j]; k < s.Lp[j + 1]; ++k)
      if (!of_M(j) || !of_M(s.Li[k])) noise[s.Li[k]] += L[k] * L[k] * wrong;
  }
  return false;
}

}  // namespace manycontact::rank
