#pragma once
// The judge of the pivots of L D L^T = K = [M J^T; J -delta I], in any order of elimination: whether a pivot, or the
// row of J it belongs to, is more than rounding. All factors ask it, SIMD batches with one value per robot (S).

#include <algorithm>
#include <cmath>
#include <vector>

#include "manycontact/sparse/ldl.hpp"
#include "manycontact/sparse/tolerances.hpp"
#include "manycontact/spatial/scalar.hpp"

namespace manycontact::rank {

/// Pivot k, and what it is compared with.
template <class S>
struct Pivot {
  bool of_M;
  S d, terms;          // D_k, and |K_kk| + sum l_kj^2 |d_j|, the terms that it is left of
  S own;               // K_kk of a row of M; the largest entry of a row of J
  S row_size = S(-1);  // size of a row of J (rank/row_size.hpp); negative where the row itself is judged elsewhere
};

/// Whether more than rounding is left of it, `margin` times over. A row of M has its own entry, too: where rows of J
/// before it bury that, these hardly moved the joints below it, so their pivots were rounding. Of terms that are
/// infinite, or no numbers, nothing is left.
template <class S>
auto is_left(const Pivot<S>& p, double margin = 1) {
  const S least = S(margin * tolerance::kPivotLeft) * p.terms, size = absolute(p.d);
  const S own = p.of_M ? least : S(margin * tolerance::kRank) * p.row_size;
  return (size > least) & (p.own > own);
}
/// Whether it has the sign of its row, which it has in any order: K has nv positive eigenvalues.
template <class S>
auto has_its_sign(const Pivot<S>& p) {
  return p.of_M ? p.d > S(0) : p.d < S(0);
}

/// Rows of J, damping 0: the error of a small pivot is as much larger in those after it, where it may look like the
/// pivot of a row that has none. So of two pivots with the parts r and s left of them, r s must be above the rounding
/// error of either. M's pivots alone, which small masses make small, decide nothing. Here any two pivots are compared.
template <class S>
struct PassedOn {
  S least = S(1), least_of_J = S(1);  // parts left, so far
  /// Whether the next pivot is more than that.
  auto accepts(bool of_M, const S& left) {
    const auto accepted = left * (of_M ? least_of_J : least) >= S(tolerance::kRowRounding);
    least = -larger(S(-left), S(-least));
    if (!of_M) least_of_J = -larger(S(-left), S(-least_of_J));
    return accepted;
  }
};

/// The same along an elimination tree: the error of a pivot reaches its ancestors, and no other pivot. memory: of the
/// caller's.
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

/// The same by L itself, sharper: the error of a pivot is the rounding of its own terms, and l^2 times the errors of
/// the pivots before it, but among M's alone. In a long tower each contact's pivots are small compared with their
/// terms, by the inertia of all above, and hardly change those below. Whether some pivot is no more than that. Rows
/// without pivot have an infinite D and no L, and pass nothing on. terms: of the pivots; noise: memory of n numbers.
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
