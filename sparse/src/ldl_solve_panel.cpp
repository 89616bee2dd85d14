#include "manycontact/sparse/ldl.hpp"
#include "manycontact/sparse/ldl_kernels.hpp"

namespace manycontact::sparse {

namespace {

constexpr int kWide = 8 * kernel::kRegister;  // the widest chunk that fits in registers together with its operands

// Solves for N columns, row by row. A row stays in registers while the rows on which it depends are read.
template <int N>
void sweep(const LdlSymbolic& s, const double* Lx, const double* D, const int* row, double* X, int ld,
           const char* nonzero) {
  using Chunk = kernel::Tile<double, N>;
  const auto at = [&](int k) { return X + static_cast<std::ptrdiff_t>(row ? row[k] : k) * ld; };
  for (int k = 0; k < s.n; ++k) {  // forward sweep X = L \ X
    if ((nonzero && !nonzero[k]) || s.Rp[k] == s.Rp[k + 1]) continue;
    Chunk x = Chunk::load(at(k));
    for (int p = s.Rp[k]; p < s.Rp[k + 1]; ++p)
      if (!nonzero || nonzero[s.Rj[p]]) x.add(-Lx[s.Rk[p]], at(s.Rj[p]));
    x.store(at(k));
  }
  for (int k = s.n - 1; k >= 0; --k) {  // backward sweep X = L^T \ (D \ X)
    Chunk x = Chunk::load(at(k));
    x = x.times(1 / D[k]);
    for (int p = s.Lp[k]; p < s.Lp[k + 1]; ++p) x.add(-Lx[p], at(s.Li[p]));
    x.store(at(k));
  }
}

}  // namespace

void ldl_solve_panel(const LdlSymbolic& s, const double* Lx, const double* D, const int* row, double* X, int ld,
                     int first, int cols, char* nonzero) {
  for (int k = 0; nonzero && k < s.n; ++k)  // flags the rows that become nonzero in the forward sweep
    for (int p = s.Rp[k]; p < s.Rp[k + 1] && !nonzero[k]; ++p) nonzero[k] = nonzero[s.Rj[p]];
  const int end = first + cols;
  while (end - first >= kWide) sweep<kWide>(s, Lx, D, row, X + first, ld, nonzero), first += kWide;
  while (end - first >= 16) sweep<16>(s, Lx, D, row, X + first, ld, nonzero), first += 16;
  while (end - first >= 8) sweep<8>(s, Lx, D, row, X + first, ld, nonzero), first += 8;
  while (first < end) sweep<1>(s, Lx, D, row, X + first, ld, nonzero), first += 1;
}

}  // namespace manycontact::sparse
