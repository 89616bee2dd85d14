// The kernels on panels of one level of instructions. Compiled once per level with that level's flags and
// MANYCONTACT_LEVEL (its name); nothing of it but the PanelKernels is seen by the linker (src/lanes.cmake).

#include <algorithm>
#include <cstddef>

#include "manycontact/sparse/instruction_levels.hpp"
#include "manycontact/sparse/ldl_kernels.hpp"
#include "manycontact/sparse/panel_kernels.hpp"

namespace manycontact::sparse {

namespace {

using kernel::kRegister;
using kernel::Tile;

// Rows far apart in memory are brought together in A's order, and a chunk of columns stays in the cache.
void solve_apart(const LdlSchedule& schedule, const double* Lx, const double* D, const int* row, double* X, int ld,
                 int first, int cols, char* nonzero, double* work) {
  ldl_scheduled_reach(schedule, nonzero);
  kernel::in_chunks<kernel::kColumns<double>>(first, first + cols, [&](int c, auto size) {
    constexpr int N = size.value;
    const auto at = [&](int k) { return X + static_cast<std::ptrdiff_t>(row[k]) * ld + c; };
    for (int k = 0; k < schedule.n; ++k) {
      if (nonzero[k])
        std::copy_n(at(k), N, work + k * N);
      else
        std::fill_n(work + k * N, N, 0.0);
    }
    kernel::sweep<N>(schedule, Lx, D, kernel::InOrder(), work, N, nonzero);
    for (int k = 0; k < schedule.n; ++k) std::copy_n(work + k * N, N, at(k));
  });
}

void panel_residual(const UpperCsc& A, const double* Ax, const int* row, const double* X, double* B, int ld, int cols) {
  const int *p = A.p.data(), *index = A.i.data();
  kernel::in_chunks<kernel::kColumns<double>>(0, cols, [&](int first, auto size) {
    constexpr int N = size.value;
    const auto at = [&](auto* panel, int k) { return panel + static_cast<std::ptrdiff_t>(row[k]) * ld + first; };
    for (int j = 0; j < A.n; ++j) {
      const double* xj = at(X, j);
      auto bj = Tile<double, N>::load(at(B, j));
      for (int k = p[j]; k < p[j + 1]; ++k) {
        const int i = index[k];
        if (i == j) {
          bj.add(-Ax[k], xj);
          continue;
        }
        auto bi = Tile<double, N>::load(at(B, i));
        bi.add(-Ax[k], xj);
        bi.store(at(B, i));
        bj.add(-Ax[k], at(X, i));
      }
      bj.store(at(B, j));
    }
  });
}

// Rows of H at a time, and columns: as many as registers hold.
constexpr int kHigh = kRegister == 8 ? 8 : 4, kWide = kRegister == 2 ? 4 : 3 * kRegister;

// M x N of H.
template <int M, int N>
inline void product_tile(const double* L, std::ptrdiff_t ldl, const double* R, int depth, std::ptrdiff_t ld,
                         double* H) {
  const double zeros[N] = {};
  Tile<double, N> t[M];
  for (int a = 0; a < M; ++a) t[a] = Tile<double, N>::load(zeros);
  for (int k = 0; k < depth; ++k, L += ldl, R += ld) {
#pragma GCC unroll 8
    for (int a = 0; a < M; ++a) t[a].add(L[a], R);
  }
  for (int a = 0; a < M; ++a) t[a].store(H + a * ld);
}

// M rows of H.
template <int M>
inline void product_rows(const double* L, std::ptrdiff_t ldl, const double* R, int depth, int cols, std::ptrdiff_t ld,
                         double* H) {
  const int end = (cols + 7) / 8 * 8;
  int j = 0;
  for (; j + kWide <= end; j += kWide) product_tile<M, kWide>(L, ldl, R + j, depth, ld, H + j);
  for (; j + 8 <= end; j += 8) product_tile<M, 8>(L, ldl, R + j, depth, ld, H + j);
  for (; j < end; j += 4) product_tile<M, 4>(L, ldl, R + j, depth, ld, H + j);
}

void upper_product(const double* L, const double* R, int depth, int cols, int ld, double* H) {
  for (int i = 0; i < (cols + 7) / 8 * 8; i += kHigh) {
    const int j = i / 8 * 8;  // blocks of eight rows from their diagonal on
    product_rows<kHigh>(L + i, ld, R + j, depth, cols - j, ld, H + static_cast<std::ptrdiff_t>(i) * ld + j);
  }
}

// The last rows are done again with some before them: fewer at a time would wait for each other.
void product(const double* L, int ldl, const double* R, int depth, int rows, int cols, int ld, double* H) {
  const auto rows_from = [&](int i, auto high) {
    product_rows<high.value>(L + i, ldl, R, depth, cols, ld, H + static_cast<std::ptrdiff_t>(i) * ld);
  };
  if (rows >= kHigh) {
    for (int i = 0; i + kHigh <= rows; i += kHigh) rows_from(i, kernel::Size<kHigh>{});
    if (rows % kHigh != 0) rows_from(rows - kHigh, kernel::Size<kHigh>{});
  } else {
    for (int i = 0; i < rows; ++i) rows_from(i, kernel::Size<1>{});
  }
}

// f(first, number) for the columns, 4 registers of them at a time.
template <class F>
inline void in_wide_chunks(int cols, F&& f) {
  constexpr int kMost = 4 * kRegister;
  const int end = (cols + 7) / 8 * 8;
  int j = 0;
  for (; j + kMost <= end; j += kMost) f(j, kernel::Size<kMost>{});
  for (; j < end; j += 8) f(j, kernel::Size<8>{});
}

void lower_solve(const double* L, int ldl, int n, double* X, int cols, int ld) {
  in_wide_chunks(cols, [&](int first, auto size) {
    constexpr int N = size.value;
    const auto at = [&](int k) { return X + static_cast<std::ptrdiff_t>(k) * ld + first; };
    for (int i = 0; i < n; ++i) {
      auto x = Tile<double, N>::load(at(i));
      for (int j = 0; j < i; ++j) x.add(-L[static_cast<std::ptrdiff_t>(j) * ldl + i], at(j));
      x.times(1 / L[static_cast<std::ptrdiff_t>(i) * ldl + i]).store(at(i));
    }
  });
}

void upper_solve(const double* L, int ldl, int n, double* X, int cols, int ld) {
  in_wide_chunks(cols, [&](int first, auto size) {
    constexpr int N = size.value;
    const auto at = [&](int k) { return X + static_cast<std::ptrdiff_t>(k) * ld + first; };
    for (int i = n - 1; i >= 0; --i) {
      const double* column = L + static_cast<std::ptrdiff_t>(i) * ldl;
      auto x = Tile<double, N>::load(at(i));
      for (int j = i + 1; j < n; ++j) x.add(-column[j], at(j));
      x.times(1 / column[i]).store(at(i));
    }
  });
}

}  // namespace

extern const PanelKernels MANYCONTACT_OF_LEVEL(level_);
const PanelKernels MANYCONTACT_OF_LEVEL(level_) = {MANYCONTACT_LEVEL_NAME,
                                                   kernel::kColumns<double>,
                                                   ldl_scheduled_factor<double>,
                                                   ldl_scheduled_solve<double>,
                                                   ldl_scheduled_residual<double>,
                                                   ldl_scheduled_solve_panel<double>,
                                                   solve_apart,
                                                   panel_residual,
                                                   upper_product,
                                                   product,
                                                   lower_solve,
                                                   upper_solve};

}  // namespace manycontact::sparse
