#pragma once
// Solves with A = L D L^T for a few columns of a panel at a time, by a compiled schedule, and row sums for error
// bounds. Four rows are computed at a time, so that a row read from the cache is used four times. With a pack as value
// type V (ldl_kernels.hpp), several panels are solved at once. This header includes no other library.

#include "manycontact/sparse/ldl_kernels.hpp"

namespace manycontact::sparse {

namespace kernel {

/// The numbers of a panel's columns and rows that are computed at a time. They fit in registers with their operands.
inline constexpr int kPanel = (kRegister == 8 ? 4 : 2) * kRegister, kPanelRows = LdlSchedule::kHigh;

/// Subtracts from R rows t of a panel the product of these rows' entries of L with the block's own rows begin ...
/// end-1, for M of the panel's N columns. own: row 0 of the block. at: index in Lx of the first of the R rows in column
/// `begin`; in column c + 1 the index of a row is larger by step - c than in column c.
template <int R, int N, int M, class V>
[[gnu::always_inline]] inline void subtract_columns(Tile<V, M>* t, const V* Lx, int at, int step, int begin, int end,
                                                    const V* own) {
  for (int c = begin; c < end; ++c) {
    const auto x = Tile<V, M>::load(own + c * N);
    const V* l = Lx + at;
#pragma GCC unroll 8
    for (int i = 0; i < R; ++i) t[i].subtract(l[i], x);
    at += step - c;
  }
}

/// Performs the forward sweep X <- L^-1 X for one block. from: the block's first row that may be nonzero.
template <int N, int M, class V>
inline void forward_panel(const LdlSchedule& schedule, int block, int from, const V* Lx, V* X) {
  const int first = schedule.block.data()[block], width = schedule.block.data()[block + 1] - first;
  const int* Lp = schedule.Lp.data() + first;
  const int step = width + (Lp[width] - Lp[width - 1]) - 2;
  const int at = Lp[from] - from - 1;  // row r of column `from` is Lx[at + r]
  V* all = X + static_cast<std::ptrdiff_t>(first) * N;
  in_chunks<kPanelRows>(from, width, [&](int r, auto size) {
    constexpr int R = size.value;
    for (V* own = all; own != all + N; own += M) {
      Tile<V, M> t[R];
#pragma GCC unroll 8
      for (int i = 0; i < R; ++i) t[i] = Tile<V, M>::load(own + (r + i) * N);
      subtract_columns<R, N, M>(t, Lx, at + r, step, from, r, own);
#pragma GCC unroll 8
      for (int i = 0; i < R; ++i) {
#pragma GCC unroll 8
        for (int j = 0; j < i; ++j) t[i].subtract(Lx[Lp[r + j] + i - j - 1], t[j]);
        t[i].store(own + (r + i) * N);
      }
    }
  });
  const int* run = schedule.run.data() + block;
  for (const LdlSchedule::Run *k = schedule.runs.data() + run[0], *end = schedule.runs.data() + run[1]; k != end; ++k)
    in_chunks<kPanelRows>(k->begin, k->end, [&](int b, auto size) {
      constexpr int R = size.value;
      V* to = X + static_cast<std::ptrdiff_t>(k->row + b - k->begin) * N;
      for (const V* own = all; own != all + N; own += M, to += M) {
        Tile<V, M> t[R];
#pragma GCC unroll 8
        for (int i = 0; i < R; ++i) t[i] = Tile<V, M>::load(to + i * N);
        subtract_columns<R, N, M>(t, Lx, at + width + b, step, from, width, own);
#pragma GCC unroll 8
        for (int i = 0; i < R; ++i) t[i].store(to + i * N);
      }
    });
}

/// Computes the R rows of a group in X <- L^-T D^-1 X, after all rows of larger index. l: the group's packed entries of
/// L. reached: whether the rows may be nonzero before the division by D. Calls store(row, tile).
template <int R, int N, int M, class V, class Store>
[[gnu::always_inline]] inline void backward_rows(const LdlSchedule::Group& group, const LdlSchedule::Segment* segments,
                                                 const V* l, const V* inverse, bool reached, V* X, Store&& store) {
  const int row = group.row;
  V* own = X + static_cast<std::ptrdiff_t>(row) * N;
  Tile<V, M> t[R];
#pragma GCC unroll 8
  for (int i = 0; i < R; ++i)
    t[i] = reached ? Tile<V, M>::load(own + i * N).times(inverse[row + i]) : Tile<V, M>::all(V{});
  for (int k = group.segment; k < group.segment_end; ++k) {
    const V* x = X + static_cast<std::ptrdiff_t>(segments[k].row) * N;
    for (const V* end = x - static_cast<std::ptrdiff_t>(segments[k].count) * N; x != end; x -= N, l += R) {
      const auto of_row = Tile<V, M>::load(x);
#pragma GCC unroll 8
      for (int i = 0; i < R; ++i) t[i].subtract(l[i], of_row);
    }
  }
  // entries of the group's own row j start at l + (j - 1) R
#pragma GCC unroll 8
  for (int i = R - 1; i >= 0; --i) {
#pragma GCC unroll 8
    for (int j = R - 1; j > i; --j) t[i].subtract(l[(j - 1) * R + i], t[j]);
    t[i].store(own + i * N);
    store(row + i, t[i]);
  }
}

/// X <- A^-1 X for an n x N panel X in A's order, M columns in registers at a time. packed: from ldl_pack. Rows without
/// a flag in `reached` (ldl_scheduled_reach) are zero before the division by D; blocks without any flag may have any
/// value. Calls store(k, row k of the solution, a tile of M columns) as soon as row k is known.
template <int N, int M = N, class V, class Store>
inline void solve_columns(const LdlSchedule& schedule, const V* Lx, const V* packed, const V* inverse,
                          const char* reached, V* X, Store&& store) {
  const int* block = schedule.block.data();
  for (int k = 0; k < schedule.blocks(); ++k) {
    int from = block[k];
    while (from < block[k + 1] && !reached[from]) ++from;
    if (from < block[k + 1]) forward_panel<N, M>(schedule, k, from - block[k], Lx, X);
  }
  const LdlSchedule::Segment* segments = schedule.segments.data();
  const LdlSchedule::Group* end = schedule.groups.data() + schedule.groups.size();
  for (const LdlSchedule::Group* group = schedule.groups.data(); group != end; ++group) {
    const auto rows = [&](auto size) {
      for (int first = 0; first < N; first += M)
        backward_rows<size.value, N, M>(*group, segments, packed + group->at, inverse,
                                        reached[group->row + size.value - 1], X + first, store);
    };
    if (group->high == 4)
      rows(Size<4>{});
    else if (group->high == 2)
      rows(Size<2>{});
    else
      rows(Size<1>{});
  }
}

}  // namespace kernel

template <class V>
void ldl_pack(const LdlSchedule& schedule, const V* Lx, V* packed) {  // the order of LdlSchedule::packed
  const int* slot = schedule.packed.data();
  const int count = static_cast<int>(schedule.packed.size());
  for (int k = 0; k < count; ++k) packed[k] = slot[k] < 0 ? V{} : Lx[slot[k]];
}

template <class V>
void ldl_row_sums(const UpperCsc& A, const V* Ax, const LdlSymbolic& symbolic, const V* Lx, const V* D, V* of_factor,
                  V* of_A) {  // sums of the rows of |L||D||L^T| and of |A|
  const int *p = A.p.data(), *row = A.i.data(), *Lp = symbolic.Lp.data(), *Li = symbolic.Li.data();
  for (int k = 0; k < A.n; ++k) of_factor[k] = of_A[k] = V{};
  for (int j = 0; j < A.n; ++j) {
    V column(1.0);  // sum of the magnitudes in column j of L
    for (int k = Lp[j]; k < Lp[j + 1]; ++k) column = column + absolute(Lx[k]);
    column = column * absolute(D[j]);
    of_factor[j] = of_factor[j] + column;
    for (int k = Lp[j]; k < Lp[j + 1]; ++k) of_factor[Li[k]] = multiply_add(absolute(Lx[k]), column, of_factor[Li[k]]);
    for (int k = p[j]; k < p[j + 1]; ++k) {
      const V size = absolute(Ax[k]);
      of_A[j] = of_A[j] + size;
      if (row[k] != j) of_A[row[k]] = of_A[row[k]] + size;
    }
  }
}

}  // namespace manycontact::sparse
