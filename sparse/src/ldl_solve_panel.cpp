#include "manycontact/sparse/ldl.hpp"

namespace manycontact::sparse {

namespace {

// A register's doubles, and the widest chunk that leaves the machine's registers room. Vectors wider than a register
// the compiler keeps in memory.
#if defined(__AVX512F__)
constexpr int kRegister = 8, kWide = 64;
#elif defined(__AVX__)
constexpr int kRegister = 4, kWide = 32;
#else
constexpr int kRegister = 2, kWide = 16;
#endif

// N doubles held in registers.
template <int N>
struct Chunk {
  typedef double Vector __attribute__((vector_size(8 * kRegister), aligned(8), may_alias));
  static constexpr int kVectors = N / kRegister;
  Vector v[kVectors];

  static Chunk load(const double* x) {
    Chunk c;
    for (int k = 0; k < kVectors; ++k) c.v[k] = *reinterpret_cast<const Vector*>(x + kRegister * k);
    return c;
  }
  void store(double* x) const {
    for (int k = 0; k < kVectors; ++k) *reinterpret_cast<Vector*>(x + kRegister * k) = v[k];
  }
  void subtract(double l, const double* x) {  // *this -= l x
    for (int k = 0; k < kVectors; ++k) v[k] -= l * *reinterpret_cast<const Vector*>(x + kRegister * k);
  }
  void scale(double s) {
    for (int k = 0; k < kVectors; ++k) v[k] *= s;
  }
};

template <>
struct Chunk<1> {
  double v;
  static Chunk load(const double* x) { return {*x}; }
  void store(double* x) const { *x = v; }
  void subtract(double l, const double* x) { v -= l * *x; }
  void scale(double s) { v *= s; }
};

// Row by row, so that a row stays in registers while the rows it depends on stream past.
template <int N>
void sweep(const LdlSymbolic& s, const double* Lx, const double* D, const int* row, double* X, int ld,
           const char* nonzero) {
  const auto at = [&](int k) { return X + static_cast<std::ptrdiff_t>(row[k]) * ld; };
  for (int k = 0; k < s.n; ++k) {  // X = L \ X
    if (!nonzero[k] || s.Rp[k] == s.Rp[k + 1]) continue;
    Chunk<N> x = Chunk<N>::load(at(k));
    for (int p = s.Rp[k]; p < s.Rp[k + 1]; ++p)
      if (nonzero[s.Rj[p]]) x.subtract(Lx[s.Rk[p]], at(s.Rj[p]));
    x.store(at(k));
  }
  for (int k = s.n - 1; k >= 0; --k) {  // X = L^T \ (D \ X)
    Chunk<N> x = Chunk<N>::load(at(k));
    x.scale(1 / D[k]);
    for (int p = s.Lp[k]; p < s.Lp[k + 1]; ++p) x.subtract(Lx[p], at(s.Li[p]));
    x.store(at(k));
  }
}

}  // namespace

void ldl_solve_panel(const LdlSymbolic& s, const double* Lx, const double* D, const int* row, double* X, int ld,
                     int first, int cols, char* nonzero) {
  for (int k = 0; k < s.n; ++k)  // the rows the forward sweep reaches
    for (int p = s.Rp[k]; p < s.Rp[k + 1] && !nonzero[k]; ++p) nonzero[k] = nonzero[s.Rj[p]];
  const int end = first + cols;
  while (end - first >= kWide) sweep<kWide>(s, Lx, D, row, X + first, ld, nonzero), first += kWide;
  while (end - first >= 16) sweep<16>(s, Lx, D, row, X + first, ld, nonzero), first += 16;
  while (end - first >= 8) sweep<8>(s, Lx, D, row, X + first, ld, nonzero), first += 8;
  while (first < end) sweep<1>(s, Lx, D, row, X + first, ld, nonzero), first += 1;
}

}  // namespace manycontact::sparse
