#include "manycontact/sparse/relaxed_supernodes.hpp"

#include <algorithm>
#include <numeric>

#include "manycontact/sparse/tolerances.hpp"

namespace manycontact::sparse {

namespace {

int count(const LdlSymbolic& L, int k) { return L.Lp[k + 1] - L.Lp[k]; }

// Flags the columns to which the relaxation of `leading` added zeros: they have more entries in `leading` than in the
// same rows of L.
std::vector<char> nested_like(const LdlSymbolic& leading, const LdlSymbolic& L) {
  std::vector<char> nested(L.n, 0);
  for (int k = 0; k < leading.n; ++k) {
    const auto begin = L.Li.begin() + L.Lp[k], end = L.Li.begin() + L.Lp[k + 1];
    nested[k] = std::lower_bound(begin, end, leading.n) - begin < count(leading, k);
  }
  return nested;
}

// Gives each flagged column k the pattern of column k + 1, its parent: row k + 1 and the rows of column k + 1.
void nest(const std::vector<char>& nested, LdlSymbolic& L) {
  std::vector<int> size(L.n), Lp(L.n + 1, 0);
  for (int k = L.n - 1; k >= 0; --k) size[k] = nested[k] ? size[k + 1] + 1 : count(L, k);
  std::partial_sum(size.begin(), size.end(), Lp.begin() + 1);
  if (Lp.back() == L.nonzeros()) return;
  std::vector<int> Li(Lp.back());
  for (int k = L.n - 1; k >= 0; --k) {
    if (nested[k]) {
      Li[Lp[k]] = k + 1;
      std::copy_n(Li.begin() + Lp[k + 1], size[k + 1], Li.begin() + Lp[k] + 1);
    } else {
      std::copy_n(L.Li.begin() + L.Lp[k], size[k], Li.begin() + Lp[k]);
    }
  }
  L.Lp = std::move(Lp);
  L.Li = std::move(Li);
  list_rows(L);
}

}  // namespace

std::vector<char> nearly_nested(const std::vector<int>& parent, const std::vector<int>& counts) {
  const int n = static_cast<int>(parent.size());
  std::vector<char> nested(n, 0);
  long rows = 0, zeros = 0, entries = 0;  // rows of the relaxed column k + 1; zeros and entries of its block so far
  for (int k = n - 1; k >= 0; --k) {
    const long own = counts[k], more = rows + 1 - own;
    nested[k] = parent[k] == k + 1 &&
                (more == 0 || (own >= tolerance::kShort && tolerance::kZeros * (zeros + more) <= entries + own + more));
    rows = nested[k] ? rows + 1 : own;
    zeros = nested[k] ? zeros + more : 0;
    entries = nested[k] ? entries + rows : own;
  }
  return nested;
}

void relax_supernodes(LdlSymbolic& L) {
  std::vector<int> counts(L.n);
  for (int k = 0; k < L.n; ++k) counts[k] = count(L, k);
  nest(nearly_nested(L.parent, counts), L);
}

void relax_supernodes(const LdlSymbolic& leading, LdlSymbolic& L) { nest(nested_like(leading, L), L); }

}  // namespace manycontact::sparse
