#pragma once
// Joining rows, in single-robot islands: rows of J without a sound pivot that are independent of the kept rows. They
// are eliminated last, by the Schur complement T (rank/waiting_rows.hpp). K1 is K of the kept rows; column k of B
// contains the k-th joining row of each element (robot). The solution (x, y) for right-hand sides (b1, b2) is
//
//     Z = K1^-1 B,    T = B^T Z = L D L^T,    y = T^-1 (Z^T b1 - b2),    x = K1^-1 b1 - Z y.

#include <algorithm>
#include <vector>

#include "../arrays.hpp"
#include "manycontact/sparse/tile.hpp"
#include "manycontact/sparse/tolerances.hpp"

namespace manycontact::lanes {

/// Factorizes G = L D L^T in place (n x n, row-major). The diagonal of G becomes inverse_of(k, D_k), i.e. 1 / D_k.
template <class S, class InverseOf>
void factor_dense(S* G, std::ptrdiff_t n, InverseOf&& inverse_of) {
  for (std::ptrdiff_t a = 0; a < n; ++a) {
    S* row = G + a * n;
    for (std::ptrdiff_t b = 0; b < a; ++b)
      for (std::ptrdiff_t c = 0; c < b; ++c) row[b] = subtract_product(row[c], G[b * n + c], row[b]);
    for (std::ptrdiff_t b = 0; b < a; ++b) {
      const S ld = row[b];
      row[b] = ld * G[b * n + b];
      row[a] = subtract_product(row[b], ld, row[a]);
    }
    row[a] = inverse_of(static_cast<int>(a), row[a]);
  }
}
template <int C, class V>
void solve_dense(const V* G, int n, V* t) {  // t = G^-1 t for C columns, row-major, after factor_dense
  using Row = sparse::kernel::Tile<V, C>;
  const auto row = [&](int a, int from, int to, auto&& l, const V& scale) {
    Row sum = Row::load(t + a * C).times(scale);
    for (int b = from; b < to; ++b) sum.subtract(l(b), Row::load(t + b * C));
    sum.store(t + a * C);
  };
  for (int a = 0; a < n; ++a)
    row(
        a, 0, a, [&](int b) { return G[a * n + b]; }, V(1));
  for (int a = n; a-- > 0;)
    row(
        a, a + 1, n, [&](int b) { return G[b * n + a]; }, G[a * n + a]);
}

template <class S>
class JoiningRows {
 public:
  static constexpr int W = S::width;
  using Mask = typename S::Mask;
  JoiningRows(int rows, std::size_t most)
      : rows_(rows), most_(static_cast<int>(most)), B_(most * rows), Z_(B_.size()), T_(most * most), t_(most) {
    listed_.resize(W * most);
  }

  void reserve(int columns) { t_.resize(std::max(t_.size(), static_cast<std::size_t>(most_ * columns))); }

  void clear() { most_in_any_ = 0, std::fill_n(count_, W, 0); }
  void add(int lane, int k) {  // adds row k to the list of an element
    listed_[lane * most_ + count_[lane]++] = k;
    most_in_any_ = std::max(most_in_any_, count_[lane]);
  }
  bool any() const { return most_in_any_ > 0; }

  /// Factorizes T. entries(lane, k, use): calls use(row of K1, entry of listed row k). terms(lane, k): terms of row k's
  /// pivot. solve(b, x): x = K1^-1 b. Calls left(lane, k) for a row that depends on K1 and earlier listed rows.
  template <class Entries, class Terms, class Solve, class Left>
  void factorize(Entries&& entries, Terms&& terms, Solve&& solve, Left&& left) {
    std::fill_n(B_.begin(), std::ptrdiff_t{most_in_any_} * rows_, S(0));
    each([&](int l, int a, int k) { entries(l, k, [&](int row, double x) { B(a)[row].set(l, x); }); });
    for (int a = 0; a < most_in_any_; ++a) {
      solve(B(a), Z(a));
      S has(0);
      each_of(a, [&](int l, int) { has.set(l, 1); });
      for (int k = 0; k < rows_; ++k) Z(a)[k] = select(has > S(0), Z(a)[k], S(0));
      for (int b = 0; b <= a; ++b) {
        S sum(0);
        for (int k = 0; k < rows_; ++k) sum = multiply_add(B(b)[k], Z(a)[k], sum);
        T_[a * most_in_any_ + b] = sum;
      }
    }
    factor_dense(T_.data(), most_in_any_, [&](int a, const S& d) {
      S least(std::numeric_limits<double>::infinity());
      each_of(a, [&](int l, int k) { least.set(l, tolerance::kJoins * terms(l, k)); });
      const Mask joins = d > least;
      each_of(a, [&](int l, int k) {
        if (!joins[l]) left(l, k);
      });
      return select(joins, S(1) / d, S(0));
    });
  }

  /// Extend a solve to listed rows: `before`, the caller's x = K1^-1 x, then `after`. x: C columns, row-major.
  template <int C, class V>
  void before(const V* x) {
    using Row = sparse::kernel::Tile<V, C>;
    V* t = as_scalar(t_.data());
    for (int a = 0; a < most_in_any_; ++a) {
      Row sum = Row::all(V(0));
      for (int k = 0; k < rows_; ++k) sum.add(*as_scalar(Z(a) + k), x + std::ptrdiff_t{k} * C);
      sum.store(t + a * C);
    }
    each([&](int l, int a, int k) {
      for (int c = 0; c < C; ++c) {
        S& to = t_[a * C + c];
        to.set(l, to[l] - reinterpret_cast<const S*>(x)[std::ptrdiff_t{k} * C + c][l]);
      }
    });
    solve_dense<C>(as_scalar(T_.data()), most_in_any_, t);
  }
  template <int C, class V>
  void after(V* x) {
    using Row = sparse::kernel::Tile<V, C>;
    for (int k = 0; k < rows_; ++k) {
      Row row = Row::load(x + std::ptrdiff_t{k} * C);
      for (int a = 0; a < most_in_any_; ++a)
        row.subtract(*as_scalar(Z(a) + k), Row::load(as_scalar(t_.data()) + a * C));
      row.store(x + std::ptrdiff_t{k} * C);
    }
    each([&](int l, int a, int k) {
      for (int c = 0; c < C; ++c) reinterpret_cast<S*>(x)[std::ptrdiff_t{k} * C + c].set(l, t_[a * C + c][l]);
    });
  }

 private:
  S* B(int a) { return B_.data() + std::ptrdiff_t{a} * rows_; }
  S* Z(int a) { return Z_.data() + std::ptrdiff_t{a} * rows_; }
  /// Call use(element, row) for the rows in column a of B, or use(element, column, row) for the rows in all columns.
  template <class Use>
  void each_of(int a, Use&& use) const {
    for (int l = 0; l < W; ++l)
      if (a < count_[l]) use(l, listed_[l * most_ + a]);
  }
  template <class Use>
  void each(Use&& use) const {
    for (int a = 0; a < most_in_any_; ++a) each_of(a, [&](int l, int k) { use(l, a, k); });
  }

  int rows_, most_, most_in_any_ = 0;
  int count_[W] = {};
  std::vector<S> B_, Z_, T_, t_;
  std::vector<int> listed_;
};

}  // namespace manycontact::lanes
