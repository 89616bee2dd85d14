#include "manycontact/sparse/ldl.hpp"

extern "C" {  // LDL 2.2's header has no extern "C"
#include <ldl.h>
}

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "manycontact/sparse/memory.hpp"

namespace manycontact::sparse {

namespace {
template <class T>
T* c(const std::vector<T>& v) {  // SuiteSparse's arguments are not const
  return const_cast<T*>(v.data());
}
}  // namespace

void LdlWorkspace::reserve(const LdlSymbolic& s) {
  const auto grow = [](auto& array, std::size_t size) {  // one by one, as an earlier call may have run out of memory
    if (array.size() < size) array.resize(size);
  };
  const std::size_t n = s.n, nnz = s.nonzeros();
  grow(Y, n), grow(pattern, n), grow(flag, n), grow(Lnz, n), grow(Li, nnz);
}

namespace {

// Computes the elimination tree and the numbers of entries of L's columns. Row k of L consists of the nodes on the
// tree's paths from the entries of column k of A to k. Throws TooLarge if L and its indices exceed the memory.
void elimination_tree(const UpperCsc& A, std::vector<int>& parent, std::vector<int>& count, std::vector<int>& flag) {
  constexpr double kBytes = 64;  // bytes per entry of L: values, patterns in three orders, schedule
  double nonzeros = 0;
  for (int k = 0; k < A.n; ++k) {
    parent[k] = -1;
    flag[k] = k;
    count[k] = 0;
    for (int q = A.p[k]; q < A.p[k + 1]; ++q)
      for (int i = A.i[q]; flag[i] != k; i = parent[i]) {
        if (parent[i] == -1) parent[i] = k;
        ++count[i];
        ++nonzeros;
        flag[i] = k;
      }
    if (k % 64 == 0 || k + 1 == A.n) require_memory(kBytes * nonzeros);
    if (nonzeros > std::numeric_limits<int>::max()) throw TooLarge(kBytes * nonzeros);
  }
}

}  // namespace

LdlSymbolic ldl_analyze(const UpperCsc& A) {
  LdlSymbolic s;
  s.n = A.n;
  s.parent.resize(A.n);
  s.Lp.assign(A.n + 1, 0);
  std::vector<int> count(A.n), flag(A.n);
  elimination_tree(A, s.parent, count, flag);
  std::partial_sum(count.begin(), count.end(), s.Lp.begin() + 1);
  for (int k : count) s.flops += static_cast<double>(k) * (k + 2);
  s.Li.resize(s.Lp[A.n]);
  std::vector<int> next(s.Lp.begin(), s.Lp.end() - 1);
  std::fill(flag.begin(), flag.end(), -1);
  for (int k = 0; k < A.n; ++k) {
    flag[k] = k;
    for (int q = A.p[k]; q < A.p[k + 1]; ++q)
      for (int i = A.i[q]; flag[i] != k; i = s.parent[i]) s.Li[next[i]++] = k, flag[i] = k;
  }
  list_rows(s);
  return s;
}

void list_rows(LdlSymbolic& L) {
  L.Rp.assign(L.n + 1, 0);
  for (int row : L.Li) ++L.Rp[row + 1];
  std::partial_sum(L.Rp.begin(), L.Rp.end(), L.Rp.begin());
  L.Rj.resize(L.Li.size());
  L.Rk.resize(L.Li.size());
  std::vector<int> next(L.Rp.begin(), L.Rp.end() - 1);
  for (int j = 0; j < L.n; ++j)
    for (int p = L.Lp[j]; p < L.Lp[j + 1]; ++p) {
      const int at = next[L.Li[p]]++;
      L.Rj[at] = j;
      L.Rk[at] = p;
    }
}

namespace {

// Moves each column's entries of L from its start, where LDL packs them, to their slots among a supernode's zeros.
void spread_columns(const LdlSymbolic& s, const LdlWorkspace& w, double* Lx) {
  for (int j = 0; j < s.n; ++j) {
    int from = s.Lp[j] + w.Lnz[j], to = s.Lp[j + 1];
    while (from < to--) Lx[to] = from > s.Lp[j] && w.Li[from - 1] == s.Li[to] ? Lx[--from] : 0;
  }
}

}  // namespace

int ldl_factor(const UpperCsc& A, const LdlSymbolic& s, const double* Ax, LdlWorkspace& w, double* Lx, double* D) {
  w.reserve(s);
  const int done = ldl_numeric(A.n, c(A.p), c(A.i), const_cast<double*>(Ax), c(s.Lp), c(s.parent), w.Lnz.data(),
                               w.Li.data(), Lx, D, w.Y.data(), w.pattern.data(), w.flag.data(), nullptr, nullptr);
  if (done == A.n) spread_columns(s, w, Lx);
  return done;
}

void ldl_factor_by_rows(const UpperCsc& A, const LdlSymbolic& s, const double* Ax, const double* least, LdlWorkspace& w,
                        double* Lx, double* D, double* scale) {
  w.reserve(s);
  double* y = w.Y.data();  // not initialised: each step leaves the entries that it used zero for later steps
  for (int k = 0; k < s.n; ++k) {
    // Solve for row l_k of L: L(0:k-1, 0:k-1) D l_k = A(0:k-1, k).
    for (int p = A.p[k]; p < A.p[k + 1]; ++p) y[A.i[p]] = Ax[p];
    double d = y[k], terms = std::abs(d);
    y[k] = 0;
    for (int p = s.Rp[k]; p < s.Rp[k + 1]; ++p) {
      const int j = s.Rj[p], end = s.Rk[p];
      const double yj = y[j];
      y[j] = 0;
      const double inverse = std::abs(D[j]) > least[j] * scale[j] ? 1 / D[j] : 0, l = yj * inverse;
      Lx[end] = inverse == 0 ? 0 : l;
      if (inverse == 0) continue;
      for (int q = s.Lp[j]; q < end; ++q) y[s.Li[q]] -= Lx[q] * yj;
      d -= l * yj;
      terms += std::abs(l * yj);
    }
    D[k] = d, scale[k] = terms;
  }
}

void ldl_solve(const LdlSymbolic& s, const double* Lx, const double* D, double* x) {
  ldl_solve_panel(s, Lx, D, nullptr, x, 1, 0, 1, nullptr);
}

void pivot_terms(const UpperCsc& A, const LdlSymbolic& s, const double* Ax, const double* Lx, const double* D,
                 double* terms) {
  for (int k = 0; k < s.n; ++k) terms[k] = std::abs(Ax[A.p[k + 1] - 1]);
  for (int j = 0; j < s.n; ++j) {
    const double d = std::abs(D[j]);
    for (int k = s.Lp[j]; k < s.Lp[j + 1]; ++k) terms[s.Li[k]] += Lx[k] * Lx[k] * d;
  }
}

double ldl_rounding(const LdlSymbolic& s) {
  int of_row = 0, of_column = 0;  // largest numbers of entries in a row and in a column of L
  for (int k = 0; k < s.n; ++k) {
    of_row = std::max(of_row, s.Rp[k + 1] - s.Rp[k]);
    of_column = std::max(of_column, s.Lp[k + 1] - s.Lp[k]);
  }
  // This counts two roundings per product in an entry of L, one per product in a row of each sweep, and divisions.
  return (2 * of_row + of_column + 8) * std::numeric_limits<double>::epsilon() / 2;
}

}  // namespace manycontact::sparse
