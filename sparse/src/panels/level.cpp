// The panel kernels of one SIMD level. As in blocks/level.cpp, the build compiles this file once per level.

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "manycontact/sparse/ldl_panel_kernels.hpp"
#include "manycontact/sparse/panel_kernels.hpp"
#include "simd/levels.hpp"

namespace manycontact::sparse {

namespace {

using kernel::kRegister;
using kernel::Tile;

// Computes ldl_scheduled_residual, four entries of a column at a time if their rows are consecutive.
void residual_vector(const UpperCsc& A, const double* Ax, const double* x, const double* b, double* r, double* scale) {
  using Four = Tile<double, 4>;
  const int *p = A.p.data(), *row = A.i.data();
  const double zeros[4] = {};
  const auto size_of = [](Four t) {
    for (int k = 0; k < Four::kVectors; ++k) t.v[k] = t.v[k] < 0 ? -t.v[k] : t.v[k];
    return t;
  };
  for (int k = 0; k < A.n; ++k) {
    r[k] = b[k];
    scale[k] = absolute(b[k]);
  }
  for (int j = 0; j < A.n; ++j) {
    const int last = p[j + 1] - 1;  // slot of the diagonal entry of column j
    const double xj = x[j], size_j = absolute(xj);
    double rj = multiply_add(-Ax[last], xj, r[j]), scale_j = multiply_add(absolute(Ax[last]), size_j, scale[j]);
    auto r_four = Four::load(zeros), scale_four = r_four;
    for (int k = p[j]; k < last;) {
      const int i = row[k];
      if (k + 4 <= last && row[k + 3] == i + 3) {
        const auto a = Four::load(Ax + k), size = size_of(a), x_i = Four::load(x + i);
        auto r_i = Four::load(r + i), scale_i = Four::load(scale + i);
        for (int v = 0; v < Four::kVectors; ++v) {
          r_i.v[v] = Four::fused(Four::every(-xj), a.v[v], r_i.v[v]);
          scale_i.v[v] = Four::fused(Four::every(size_j), size.v[v], scale_i.v[v]);
        }
        r_i.store(r + i);
        scale_i.store(scale + i);
        r_four.add(a, x_i);
        scale_four.add(size, size_of(x_i));
        k += 4;
        continue;
      }
      const double size = absolute(Ax[k]);
      r[i] = multiply_add(-Ax[k], xj, r[i]);
      scale[i] = multiply_add(size, size_j, scale[i]);
      rj = multiply_add(-Ax[k], x[i], rj);
      scale_j = multiply_add(size, absolute(x[i]), scale_j);
      ++k;
    }
    double sums[4], sizes[4];
    r_four.store(sums);
    scale_four.store(sizes);
    r[j] = rj - ((sums[0] + sums[1]) + (sums[2] + sums[3]));
    scale[j] = scale_j + ((sizes[0] + sizes[1]) + (sizes[2] + sizes[3]));
  }
}

// Returns 1 / d, or 0 if |d| <= least[k] scale: row k then waits (is not eliminated). may_wait: how many rows may.
struct InverseOrWait {
  const double* least;
  int may_wait;
  double operator()(int k, double d, double scale) {
    if (!least || absolute(d) > least[k] * scale) return 1 / d;
    --may_wait;
    return 0;
  }
  bool stops() const { return may_wait < 0; }
};

void factor(const LdlSchedule& schedule, const double* Ax, const double* least, int most, double* Lx, double* D,
            double* scale) {
  ldl_scheduled_factor(schedule, Ax, Lx, D, scale, kernel::NoPrefetch{}, InverseOrWait{least, most});
}

double* aligned(double* work) {
  return reinterpret_cast<double*>((reinterpret_cast<std::uintptr_t>(work) + 63) / 64 * 64);
}

// Writes the inverse pivots to `inverse`, and L's packed entries after these. Returns the packed entries' address.
const double* prepare(const LdlSchedule& schedule, const double* Lx, const double* D, double* inverse) {
  for (int k = 0; k < schedule.n; ++k) inverse[k] = 1 / D[k];
  ldl_pack(schedule, Lx, inverse + schedule.n);
  return inverse + schedule.n;
}

// Solves in chunks of columns. Each chunk is copied to `work` in A's order, so that it stays in the first-level cache.
void solve(const LdlSchedule& schedule, const double* Lx, const double* D, const int* row, double* X, int ld, int first,
           int cols, char* nonzero, double* work) {
  const std::ptrdiff_t n = schedule.n;
  ldl_scheduled_reach(schedule, nonzero);
  double *x = aligned(work), *inverse = x + n * kernel::kPanel;
  const double* packed = prepare(schedule, Lx, D, inverse);
  kernel::in_chunks<kernel::kPanel>(first, first + cols, [&](int c, auto size) {
    constexpr int N = size.value;
    const auto at = [&](int k) { return X + static_cast<std::ptrdiff_t>(row[k]) * ld + c; };
    const double zeros[N] = {};
    for (int k = 0; k < schedule.n; ++k) Tile<double, N>::load(nonzero[k] ? at(k) : zeros).store(x + k * N);
    kernel::solve_columns<N>(schedule, Lx, packed, inverse, nonzero, x, [&](int k, const auto& t) { t.store(at(k)); });
  });
}

// B -= A X for N columns; X(k) and B(k) point to row k.
template <int N, class RowX, class RowB>
inline void subtract_product(const UpperCsc& A, const double* Ax, RowX&& X, RowB&& B) {
  const int *p = A.p.data(), *index = A.i.data();
  for (int j = 0; j < A.n; ++j) {
    const int last = p[j + 1] - 1;  // slot of the diagonal entry of column j
    const auto xj = Tile<double, N>::load(X(j));
    auto bj = Tile<double, N>::load(B(j));
    bj.subtract(Ax[last], xj);
    for (int k = p[j]; k < last; ++k) {
      double* to = B(index[k]);
      auto bi = Tile<double, N>::load(to);
      bi.subtract(Ax[k], xj);
      bi.store(to);
      bj.subtract(Ax[k], Tile<double, N>::load(X(index[k])));
    }
    bj.store(B(j));
  }
}

void panel_residual(const UpperCsc& A, const double* Ax, const int* row, const double* X, double* B, int ld, int cols) {
  kernel::in_chunks<8 * kRegister>(0, cols, [&](int first, auto size) {
    const auto at = [&](int k) { return static_cast<std::ptrdiff_t>(row[k]) * ld + first; };
    subtract_product<size.value>(
        A, Ax, [&](int k) { return X + at(k); }, [&](int k) { return B + at(k); });
  });
}

// Solves and refines in chunks of columns. The right-hand sides, solution and correction of a chunk fit into the cache.
void solve_refined(const LdlSchedule& schedule, const UpperCsc& A, const double* Ax, const double* Lx, const double* D,
                   const int* row, double* X, int ld, int first, int cols, char* nonzero, double* work) {
  const std::ptrdiff_t n = schedule.n;
  ldl_scheduled_reach(schedule, nonzero);
  double *x = aligned(work), *r = x + n * kernel::kPanel, *inverse = r + n * kernel::kPanel;
  const double* packed = prepare(schedule, Lx, D, inverse);
  char* everywhere = reinterpret_cast<char*>(inverse + n + schedule.packed.size());
  std::fill_n(everywhere, n, 1);
  kernel::in_chunks<kernel::kPanel>(first, first + cols, [&](int c, auto size) {
    constexpr int N = size.value;
    const auto at = [&](int k) { return X + static_cast<std::ptrdiff_t>(row[k]) * ld + c; };
    const double zeros[N] = {};
    for (int k = 0; k < schedule.n; ++k) {
      const auto b = Tile<double, N>::load(nonzero[k] ? at(k) : zeros);
      b.store(x + k * N);
      b.store(r + k * N);
    }
    kernel::solve_columns<N>(schedule, Lx, packed, inverse, nonzero, x, [](int, const auto&) {});
    subtract_product<N>(
        A, Ax, [x](int k) { return x + k * N; }, [r](int k) { return r + k * N; });
    kernel::solve_columns<N>(schedule, Lx, packed, inverse, everywhere, r, [&](int k, const auto& t) {
      auto sum = Tile<double, N>::load(x + k * N);
      sum.subtract(-1, t);
      sum.store(at(k));
    });
  });
}

// Rows and columns of H computed at a time: as many as fit in registers.
constexpr int kHigh = kRegister == 8 ? 8 : 4, kWide = kRegister == 2 ? 4 : 3 * kRegister;

// The offset of row i in memory, for rows at a fixed distance (Strided), or for rows in any order (Indexed).
struct Strided {
  std::ptrdiff_t ld;
  std::ptrdiff_t operator()(int i) const { return i * ld; }
};
struct Indexed {
  const int* row;
  std::ptrdiff_t ld;
  std::ptrdiff_t operator()(int i) const { return row[i] * ld; }
};

template <int M, int N, class Rows>
inline void product_tile(const double* L, std::ptrdiff_t ldl, const double* R, Rows from, int depth, double* H, Rows to,
                         bool non_temporal) {
  const double zeros[N] = {};
  Tile<double, N> t[M];
  for (int a = 0; a < M; ++a) t[a] = Tile<double, N>::load(zeros);
  for (int k = 0; k < depth; ++k, L += ldl) {
    const double* r = R + from(k);
#pragma GCC unroll 8
    for (int a = 0; a < M; ++a) t[a].add(L[a], r);
  }
  for (int a = 0; a < M; ++a)
    if (non_temporal)
      t[a].stream(H + to(a));
    else
      t[a].store(H + to(a));
}

template <int M, class Rows>
inline void product_rows(const double* L, std::ptrdiff_t ldl, const double* R, Rows from, int depth, int cols,
                         double* H, Rows to, bool non_temporal = false) {
  const int end = (cols + 7) / 8 * 8;
  int j = 0;
  for (; j + kWide <= end; j += kWide) product_tile<M, kWide>(L, ldl, R + j, from, depth, H + j, to, non_temporal);
  for (; j + 8 <= end; j += 8) product_tile<M, 8>(L, ldl, R + j, from, depth, H + j, to, non_temporal);
  for (; j < end; j += 4) product_tile<M, 4>(L, ldl, R + j, from, depth, H + j, to, non_temporal);
}

void upper_product(const double* L, const double* R, int depth, int cols, int ld, double* H) {
  for (int i = 0; i < (cols + 7) / 8 * 8; i += kHigh) {
    const int j = i / 8 * 8;  // blocks of eight rows, from the diagonal on
    const Strided rows{ld};
    product_rows<kHigh>(L + i, ld, R + j, rows, depth, cols - j, H + rows(i) + j, rows);
  }
}

// The last chunk of kHigh rows overlaps the chunk before it: fewer rows at a time would wait for each other's results.
void product(const double* L, int ldl, const double* R, int depth, int rows, int cols, int ld, double* H) {
  const auto rows_from = [&](int i, auto high) {
    const Strided strided{ld};
    product_rows<high.value>(L + i, ldl, R, strided, depth, cols, H + strided(i), strided);
  };
  if (rows >= kHigh) {
    for (int i = 0; i + kHigh <= rows; i += kHigh) rows_from(i, kernel::Size<kHigh>{});
    if (rows % kHigh != 0) rows_from(rows - kHigh, kernel::Size<kHigh>{});
  } else {
    for (int i = 0; i < rows; ++i) rows_from(i, kernel::Size<1>{});
  }
}

// Unlike in `product`, no row is computed twice, since the first result may not have reached memory if it was streamed.
void product_of_rows(const double* L, int ldl, const double* R, const int* from, int depth, double* H, const int* to,
                     int rows, int cols, int ld, bool non_temporal) {
  kernel::in_chunks<kHigh>(0, rows, [&](int i, auto high) {
    product_rows<high.value>(L + i, ldl, R, Indexed{from, ld}, depth, cols, H, Indexed{to + i, ld}, non_temporal);
  });
  if (non_temporal) kernel::finish_streams();
}

template <class F>
inline void in_wide_chunks(int cols, F&& f) {  // f(first, size)
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
                                                   kernel::kPanel,
                                                   factor,
                                                   ldl_scheduled_solve<double>,
                                                   residual_vector,
                                                   solve,
                                                   solve_refined,
                                                   panel_residual,
                                                   upper_product,
                                                   product,
                                                   product_of_rows,
                                                   lower_solve,
                                                   upper_solve};

}  // namespace manycontact::sparse
