#pragma once
// A = L D L^T and solves by a compiled schedule. The value type V is a double, or a pack with one double for each of
// several matrices of the same pattern. A pack needs + - * /, unary -, V{} = 0, V(1.0), absolute(a), multiply_add(a, b,
// c) = a b + c and subtract_product(a, b, c) = c - a b, the last two rounded as for doubles. A matrix has the same
// factor, bit for bit, alone and in a pack. This header is compiled for several SIMD levels, so it has templates and
// plain memory only and includes no other library.

#include <type_traits>

#include "manycontact/sparse/ldl_schedule.hpp"
#include "manycontact/sparse/tile.hpp"

namespace manycontact::sparse {

namespace kernel {

/// t += the sum over columns c of a block of u[c stride] times N successive entries of L in column c. x: the entries in
/// column 0; from column c to c + 1 the address of a row's entry grows by step - c.
template <class V, int N>
inline void accumulate(Tile<V, N>& t, const V* x, int step, const V* u, int stride, int columns) {
  for (int c = 0; c < columns; ++c, u += stride) {
    t.add(*u, x);
    x += step - c;
  }
}

struct Inverse {
  template <class V>
  V operator()(int, const V& d, const V&) const {
    return V(1.0) / d;
  }
};

/// Eliminates the columns of a block one by one: `width` columns from `first` on, with `below` rows below them.
template <class V, class InverseOf>
void factor_block(int first, int width, int below, V* L, V* D, V* scale, InverseOf& inverse_of) {
  V u[LdlSchedule::kWidest];  // u[c] = -L_ac D_c in row a, for the block's columns c < a
  const int step = width + below - 2;
  V* column = L;
  for (int a = 0; a < width; ++a) {
    V d = D[a], s = scale[a];
    const V* l = L + a;  // l[-1] is L_ac; a pointer to L_ac itself would be undefined for a = 0 and a null L
    for (int c = 0; c < a; ++c) {
      u[c] = -(l[-1] * D[c]);
      d = multiply_add(l[-1], u[c], d);
      s = multiply_add(absolute(l[-1]), absolute(u[c]), s);
      l += step - c;
    }
    D[a] = d;
    scale[a] = s;
    const V inverse = inverse_of(first + a, d, s);
    const int count = width + below - a - 1;
    in_chunks<kRows<V>>(0, count, [&](int i, auto size) {
      auto t = Tile<V, size.value>::load(column + i);
      accumulate(t, L + a + i, step, u, 1, a);
      t.times(inverse).store(column + i);
    });
    column += count;
  }
}

/// Subtracts this block's products from N columns of a later block T, which are rows a ... a+N-1 below this block.
template <int N, class V>
inline void update_columns(const LdlSchedule& schedule, const LdlSchedule::Run& run, int a, int width, int below,
                           const V* L, const V* D, V* Lx, V* D_all, V* scale) {
  V u[LdlSchedule::kWidest * N];  // u[N c + i] = -L_ac D_c for row a + i below this block and its column c
  const int step = width + below - 2;
  const int row = run.row + a - run.begin;
  auto d = Tile<V, N>::load(D_all + row), s = Tile<V, N>::load(scale + row);
  const V* x = L + width - 1;  // entry of L in the first row below the block, in column 0
  for (int c = 0; c < width; ++c) {
    const V* l = x + a + c * step - c * (c - 1) / 2;
    const auto l_a = Tile<V, N>::load(l);
    const auto u_a = l_a.times(-D[c]);
    u_a.store(u + N * c);
    d.add(l_a, u_a);
    s.add(l_a, l_a.times(absolute(D[c])));
  }
  d.store(D_all + row);
  s.store(scale + row);
  const LdlSchedule::Target* targets = schedule.targets.data();
  const int* Lp = schedule.Lp.data();
  for (int i = 0; i < N; ++i) {
    V* column = Lx + Lp[row + i] - (row + i - run.first) - 1;
    for (int k = run.target; k < run.target_end; ++k) {
      const LdlSchedule::Target& target = targets[k];
      V* y = column + target.shift;
      in_chunks<kRows<V>>(target.begin > a + i ? target.begin : a + i + 1, target.end, [&](int b, auto size) {
        auto t = Tile<V, size.value>::load(y + b);
        accumulate(t, x + b, step, u + i, N, width);
        t.store(y + b);
      });
    }
  }
}

/// Performs the forward sweep x <- L^-1 x for one block. own: entries of x in the block's own rows.
template <class V>
inline void forward(int width, int below, const V* L, const LdlSchedule::Run* run, const LdlSchedule::Run* end, V* own,
                    V* x) {
  V u[LdlSchedule::kWidest];  // u[c] = -x_c for columns c of the block
  const int step = width + below - 2;
  for (int a = 0; a < width; ++a) {
    V x_a = own[a];
    const V* l = L + a;  // l[-1] is L_ac
    for (int c = 0; c < a; ++c) {
      x_a = multiply_add(l[-1], u[c], x_a);
      l += step - c;
    }
    own[a] = x_a;
    u[a] = -x_a;
  }
  for (; run != end; ++run)
    in_chunks<kRows<V>>(run->begin, run->end, [&](int b, auto size) {
      V* y = x + run->row + b - run->begin;
      auto t = Tile<V, size.value>::load(y);
      accumulate(t, L + width - 1 + b, step, u, 1, width);
      t.store(y);
    });
}

/// Performs the backward sweep x <- L^-T D^-1 x for one block. Each column's sum starts with the rows below the block,
/// four at a time. own: entries of x in the block's own rows.
template <class V, class Prefetch>
inline void backward(int width, int below, const V* L, const V* D, const LdlSchedule::Run* run,
                     const LdlSchedule::Run* end, V* own, const V* x, Prefetch prefetch) {
  const int step = width + below - 2;
  const V* column = L + (width - 1) * (step + 1) - (width - 1) * (width - 2) / 2;
  for (int c = width - 1; c >= 0; --c) {  // `column` points to row c + 1 of column c
    const V* l = column + width - 1 - c;  // entry of L in column c, in the first row below the block
    const V zeros[4] = {};
    auto four = Tile<V, 4>::load(zeros);
    V rest{};
    for (const LdlSchedule::Run* r = run; r != end; ++r) {
      const V* y = x + r->row - r->begin;
      int b = r->begin;
      for (; b + 4 <= r->end; b += 4) {
        for (int i = b; i < b + 4; ++i) prefetch.fetch(l + i);
        four.add(Tile<V, 4>::load(l + b), Tile<V, 4>::load(y + b));
      }
      for (; b < r->end; ++b) {
        prefetch.fetch(l + b);
        rest = multiply_add(l[b], y[b], rest);
      }
    }
    V sums[4];
    four.store(sums);
    V x_c = own[c] / D[c] - ((sums[0] + sums[1]) + (sums[2] + sums[3]) + rest);
    for (int a = width - 1; a > c; --a) x_c = multiply_add(-column[a - c - 1], own[a], x_c);
    own[c] = x_c;
    if (c > 0) column -= step - c + 2;
  }
}

}  // namespace kernel

/// Computes the factor of the matrix with entries Ax, and scale (n) as in pivot_terms (ldl.hpp). Lx is ordered as in
/// LdlSymbolic. The type A may be more precise than V. After a zero pivot, L and D are not finite; the caller must
/// check D and scale. A row whose inverse_of(k, D_k, scale[k]) is zero is not eliminated, and its column of L is zero.
/// If inverse_of has a member stops(), the factorization ends after the first block for which it is true.
template <class A, class V, class Prefetch = kernel::NoPrefetch, class InverseOf = kernel::Inverse>
void ldl_scheduled_factor(const LdlSchedule& schedule, const A* Ax, V* Lx, V* D, V* scale, Prefetch prefetch = {},
                          InverseOf inverse_of = {}) {
  const int *Lp = schedule.Lp.data(), *block = schedule.block.data(), *run = schedule.run.data();
  const LdlSchedule::Run* runs = schedule.runs.data();
  const int* fill = schedule.fill.data();
  const int left = static_cast<int>(schedule.fill.size());
  for (int k = 0; k < left; ++k) {
    prefetch.fetch_to_write(Lx + fill[k]);
    Lx[fill[k]] = V{};
  }
  const int *from = schedule.from.data(), *to = schedule.to.data();
  const int entries = static_cast<int>(schedule.to.size());
  for (int k = 0; k < entries; ++k) {
    prefetch.fetch(Ax + from[k]);
    prefetch.fetch_to_write(Lx + to[k]);
    Lx[to[k]] = static_cast<V>(Ax[from[k]]);
  }
  for (int k = 0; k < schedule.n; ++k) {
    D[k] = static_cast<V>(Ax[schedule.diagonal.data()[k]]);
    scale[k] = absolute(D[k]);
  }
  for (int k = 0; k < schedule.eliminated; ++k) {
    const int first = block[k], width = block[k + 1] - first, below = Lp[block[k + 1]] - Lp[block[k + 1] - 1];
    V* L = Lx + Lp[first];
    kernel::factor_block(first, width, below, L, D + first, scale + first, inverse_of);
    for (int r = run[k]; r < run[k + 1]; ++r)
      kernel::in_chunks<4>(runs[r].begin, runs[r].end, [&](int a, auto size) {
        kernel::update_columns<size.value>(schedule, runs[r], a, width, below, L, D + first, Lx, D, scale);
      });
    if constexpr (requires { inverse_of.stops(); })
      if (inverse_of.stops()) return;
  }
}

/// x <- L^-1 x. After a partial elimination, the last entries of x become the Schur complement's right-hand side.
template <class V>
void ldl_scheduled_forward(const LdlSchedule& schedule, const V* Lx, V* x) {
  const int *Lp = schedule.Lp.data(), *block = schedule.block.data(), *run = schedule.run.data();
  const LdlSchedule::Run* runs = schedule.runs.data();
  for (int k = 0; k < schedule.eliminated; ++k) {
    const int first = block[k], width = block[k + 1] - first, below = Lp[block[k + 1]] - Lp[block[k + 1] - 1];
    kernel::forward(width, below, Lx + Lp[first], runs + run[k], runs + run[k + 1], x + first, x);
  }
}

/// x <- L^-T D^-1 x. After a partial elimination, the last entries of x must be the Schur complement's solution.
template <class V, class Prefetch = kernel::NoPrefetch>
void ldl_scheduled_backward(const LdlSchedule& schedule, const V* Lx, const V* D, V* x, Prefetch prefetch = {}) {
  const int *Lp = schedule.Lp.data(), *block = schedule.block.data(), *run = schedule.run.data();
  const LdlSchedule::Run* runs = schedule.runs.data();
  for (int k = schedule.eliminated - 1; k >= 0; --k) {
    const int first = block[k], width = block[k + 1] - first, below = Lp[block[k + 1]] - Lp[block[k + 1] - 1];
    kernel::backward(width, below, Lx + Lp[first], D + first, runs + run[k], runs + run[k + 1], x + first, x, prefetch);
  }
}

template <class V>
void ldl_scheduled_solve(const LdlSchedule& schedule, const V* Lx, const V* D, V* x) {
  ldl_scheduled_forward(schedule, Lx, x);
  ldl_scheduled_backward(schedule, Lx, D, x);
}

/// Adds to the flags of nonzero rows of x those rows that become nonzero in the forward sweep x <- L^-1 x.
inline void ldl_scheduled_reach(const LdlSchedule& schedule, char* nonzero) {
  for (int k = 0; k < schedule.blocks(); ++k) {
    char any = 0;
    for (int i = schedule.block.data()[k]; i < schedule.block.data()[k + 1]; ++i) nonzero[i] = any |= nonzero[i];
    for (int r = schedule.run.data()[k]; any && r < schedule.run.data()[k + 1]; ++r) {
      const LdlSchedule::Run& run = schedule.runs.data()[r];
      for (int i = 0; i < run.end - run.begin; ++i) nonzero[run.row + i] = 1;
    }
  }
}

struct NoSizes {};  // ldl_scheduled_residual then computes no scale
/// Computes r = b - A x, and scale[k] = |b_k| + sum_j |A_kj x_j| unless Scale is NoSizes. All have length A.n.
template <class V, class Scale = NoSizes, class Prefetch = kernel::NoPrefetch>
void ldl_scheduled_residual(const UpperCsc& A, const V* Ax, const V* x, const V* b, V* r, Scale scale = {},
                            Prefetch prefetch = {}) {
  constexpr bool kSizes = !std::is_same_v<Scale, NoSizes>;
  const int *p = A.p.data(), *row = A.i.data();
  for (int k = 0; k < A.n; ++k) {
    r[k] = b[k];
    if constexpr (kSizes) scale[k] = absolute(b[k]);
  }
  for (int j = 0; j < A.n; ++j) {
    const int last = p[j + 1] - 1;  // slot of the diagonal entry of column j
    const V x_j = x[j], size_j = absolute(x_j);
    V r_j = multiply_add(-Ax[last], x_j, r[j]), scale_j{};
    if constexpr (kSizes) scale_j = multiply_add(absolute(Ax[last]), size_j, scale[j]);
    for (int k = p[j]; k < last; ++k) {
      const int i = row[k];
      prefetch.fetch(Ax + k);
      const V a = -Ax[k], size = absolute(a);
      r[i] = multiply_add(a, x_j, r[i]);
      if constexpr (kSizes) scale[i] = multiply_add(size, size_j, scale[i]);
      r_j = multiply_add(a, x[i], r_j);
      if constexpr (kSizes) scale_j = multiply_add(size, absolute(x[i]), scale_j);
    }
    r[j] = r_j;
    if constexpr (kSizes) scale[j] = scale_j;
  }
}

}  // namespace manycontact::sparse
