#pragma once
// Waiting rows of J in a SIMD batch (rank/dependent_rows.hpp), i.e. rows without a sound pivot. Each element (robot)
// lists its own waiting rows; their inverse pivots are zero. The columns of N span the null space of J^T. Column k is,
// per element, e - z, where e is the unit vector of the k-th listed row, and this row equals J^T z, a combination of
// kept rows. In single-robot islands, independent waiting rows join the kept rows (joining_rows.hpp). Q are the
// orthogonalised columns of N; P projects on their span.

#include <limits>
#include <span>
#include <vector>

#include "../arrays.hpp"
#include "joining_rows.hpp"
#include "manycontact/sparse/ldl_kernels.hpp"
#include "manycontact/sparse/tolerances.hpp"

namespace manycontact::lanes {

template <class S>
class WaitingRows {
 public:
  static constexpr int W = S::width;
  using Mask = typename S::Mask;
  explicit WaitingRows(const BlockPlan& plan);

  void reserve(int columns) {  // memory to project `columns` columns at a time
    t_.resize(std::max(t_.size(), most_ * static_cast<std::size_t>(columns)));
    joining_.reserve(columns);
  }

  void use(S* memory) {  // memory of the current robots: BlockPlan::waiting_size numbers each
    waiting_ = memory;
    row_terms_ = waiting_ + 1;
    row_size_ = row_terms_ + rows_;
    entry_ = row_size_ + rows_;
    null_component_ = entry_ + rows_;
    N_ = null_component_ + rows_;
    inverse_ = N_ + 2 * most_ * rows_;
    count_ = reinterpret_cast<int*>(inverse_ + most_);
    listed_ = count_ + 1 + W;
    lists_ = listed_ + most_ * W;
  }
  /// The size of row k of J (rank/row_size.hpp), and the row's largest entry, k in K's order. Set before factorizing.
  S& row_size(int k) const { return row_size_[k]; }
  S& largest_entry(int k) const { return entry_[k]; }
  S& row_terms(int k) const { return row_terms_[k]; }  // largest term of row k's a0, to judge inconsistency
  const S& null_component(int k) const { return null_component_[k]; }  // entry k of P x that take_out subtracted

  /// any: whether any element has waiting rows. elements: those with waiting or joined rows. of: an element's
  /// redundant rows.
  bool any() const { return *count_ > 0 || joining_.any(); }
  Mask elements() const { return *waiting_ > S(0); }
  std::span<const int> of(int lane) const {
    return {listed_ + lane * most_, static_cast<std::size_t>(count_[1 + lane])};
  }

  /// Returns the multiple of its rounding error below which a pivot makes its row wait; 1 if rows cannot join.
  double margin() const { return can_join_ ? tolerance::kWaits : 1; }
  /// clear: empties all lists before a factorization. add: lists row k in elements where its pivot is not sound.
  void clear() {
    std::fill_n(count_, 1 + W, 0);
    joining_.clear();
  }
  void add(int k, Mask sound) const {
    for (int l = 0; l < W; ++l) {
      if (sound[l]) continue;
      int& count = count_[1 + l];
      if (count < static_cast<int>(most_)) listed_[l * static_cast<int>(most_) + count] = k;
      ++count;
    }
    *count_ = 1;
  }

  /// Computes N and Q after the factorization. Returns the usable elements whose waiting rows all join the kept rows,
  /// or depend on kept rows with tolerable coefficients z. solve(x): overwrites x with K1^-1 x; K1 is K of kept rows.
  template <class Solve>
  Mask hold(Mask usable, const S* K, const S* L, S* D, S* pivot_terms, Solve&& solve);

  /// Extend a solve to joined rows: before_solve, the caller's x = K1^-1 x, after_solve. x: C columns, row-major.
  template <int C, class V>
  void before_solve(const V* x) {
    if (joining_.any()) joining_.template before<C>(x);
  }
  template <int C, class V>
  void after_solve(V* x) {
    if (joining_.any()) joining_.template after<C>(x);
  }

  /// Sets `judged` to the sizes relative to which residuals of all rows are judged (rank::scale_of_dependent).
  void scale_of_dependent(const S* scale, S* judged) const {
    std::copy_n(scale, rows_, judged);
    for (int c = 0; c < *count_; ++c) {
      S sum(0);
      for (int j : column(c)) sum = multiply_add(abs(N(c, j)), scale[j], sum);
      each_of_column(c, [&](int l, int k) { judged[k].set(l, sum[l]); });
    }
  }

  void project_out(S* x) { project_out<1>(as_scalar(x)); }  // x -= P x in the rows of J
  /// Sets x -= P x in the rows of J, and stores P x in null_component.
  void take_out(S* x) {
    project_out(x);
    std::fill_n(null_component_, rows_, S(0));
    for (int c = 0; c < *count_; ++c)
      for (int j : column(of_Q(c))) null_component_[j] = multiply_add(N(of_Q(c), j), t_[c], null_component_[j]);
  }
  template <int C, class V>
  void project_out(V* x) {
    subtract_null_component<C>(x, x);
  }
  template <int C, class V>
  void subtract_null_component(const V* y, V* x) {  // x -= P y for C columns, row-major
    using Row = sparse::kernel::Tile<V, C>;
    V* t = as_scalar(t_.data());
    for (int c = 0; c < *count_; ++c) {
      Row sum = Row::all(V(0));
      for (int j : column(of_Q(c))) sum.add(*as_scalar(&N(of_Q(c), j)), y + std::ptrdiff_t{j} * C);
      sum.times(*as_scalar(inverse_ + c)).store(t + c * C);
    }
    for (int c = 0; c < *count_; ++c) {
      const Row of_column = Row::load(t + c * C);
      for (int j : column(of_Q(c))) {
        Row row = Row::load(x + std::ptrdiff_t{j} * C);
        row.subtract(*as_scalar(&N(of_Q(c), j)), of_column);
        row.store(x + std::ptrdiff_t{j} * C);
      }
    }
  }

 private:
  static constexpr int kJoined = -1;  // replaces, in an element's list, the number of a row that joined
  struct Entry {  // an entry of J in K (row: the coordinate), or of L between rows of J (row: the earlier one)
    int row, slot;
  };
  struct Entries {  // lists of entries, one per row of K
    std::vector<int> first;
    std::vector<Entry> of;
    std::span<const Entry> at(int k) const { return std::span(of).subspan(first[k], first[k + 1] - first[k]); }
  };

  int of_Q(int c) const { return static_cast<int>(most_) + c; }  // index of Q's column c in the array of N and Q
  S& N(int c, int row) const { return N_[static_cast<std::ptrdiff_t>(c) * rows_ + row]; }
  /// column: the rows of a column that are nonzero in any element, ascending. list: these rows after their count.
  int* list(int c) const { return lists_ + c * (static_cast<int>(of_J_.size()) + 1); }
  std::span<const int> column(int c) const { return {list(c) + 1, static_cast<std::size_t>(*list(c))}; }
  void list_column(int c) const {
    int* rows = list(c);
    rows[0] = 0;
    for (int k : of_J_)
      if (!is_zero(N(c, k))) rows[++rows[0]] = k;
  }
  template <class Use>
  void each_of_column(int c, Use&& use) const {  // calls use(element, row) for the waiting rows in column c
    for (int l = 0; l < W; ++l)
      if (c < count_[1 + l]) use(l, of(l)[c]);
  }
  static bool is_zero(const S& x) { return (abs(x) <= S(0)).all(); }
  static S without_rounding(const S& z) { return select(abs(z) <= S(tolerance::kNullEntry), S(0), z); }

  Mask count(Mask usable, S* D, S* pivot_terms);
  template <class Solve>
  void join(const S* K, Solve&& solve);
  template <class Solve>
  Mask refine(int c, Mask of, const S* K, Solve&& solve);
  void forget(int lane);
  void null_column(int c, const S* L);
  S residual(int c, const S* K);
  template <class Solve>
  void refine_column(int c, Mask open, Solve&& solve);
  Mask make_orthogonal(Mask of, const S* K);

  const KktPattern& pattern_;
  int rows_;
  std::size_t most_;
  bool can_join_;
  std::vector<int> of_J_;       // rows of J in K's order, ascending
  Entries of_row_, of_factor_;  // entries of J in K; entries of L between rows of J
  S *waiting_, *row_terms_, *row_size_, *entry_, *null_component_;  // number of waiting rows; others: one per row of K
  S *N_, *inverse_;                // N and Q by columns; inverse squared norms of Q's columns
  int *count_, *listed_, *lists_;  // number of N's columns, then of each element's rows; the rows; memory of list()
  std::vector<S> left_, x_, t_;    // scratch: J^T n; a vector in K's order; coefficients of Q's columns
  std::vector<S> terms_, error_;   // terms of removed pivots; relative residual J^T n of each column of N
  JoiningRows<S> joining_;
};

template <class S>
WaitingRows<S>::WaitingRows(const BlockPlan& plan)
    : pattern_(*plan.pattern),
      rows_(plan.rows()),
      most_(plan.most_waiting()),
      can_join_(plan.border() == 0),
      left_(rows_),
      x_(plan.pattern->size()),
      t_(most_),
      terms_(rows_),
      error_(most_),
      joining_(rows_, can_join_ ? most_ : 0) {
  const KktPattern& p = *plan.pattern;
  const auto of_M = [&p](int k) { return p.perm[k] < p.nv; };
  for (int k = 0; k < rows_; ++k)
    if (!of_M(k)) of_J_.push_back(k);
  const auto fill = [this](Entries& to, auto&& each) {
    to.first.assign(rows_ + 2, 0);
    each([&](int row, Entry) { ++to.first[row + 2]; });
    for (int k = 2; k <= rows_ + 1; ++k) to.first[k] += to.first[k - 1];
    to.of.resize(to.first.back());
    each([&](int row, Entry entry) { to.of[to.first[row + 1]++] = entry; });
  };
  fill(of_row_, [&](auto&& use) {
    for (int k = 0; k < rows_; ++k)
      for (int slot = p.K.p[k]; slot < p.K.p[k + 1]; ++slot)
        if (const int i = p.K.i[slot]; of_M(i) != of_M(k)) of_M(k) ? use(i, Entry{k, slot}) : use(k, Entry{i, slot});
  });
  fill(of_factor_, [&](auto&& use) {
    for (int k : of_J_)
      for (int q = p.ldl.Rp[k]; q < p.ldl.Rp[k + 1]; ++q)
        if (!of_M(p.ldl.Rj[q])) use(k, Entry{p.ldl.Rj[q], p.ldl.Rk[q]});
  });
}

template <class S>
template <class Solve>
typename S::Mask WaitingRows<S>::hold(Mask usable, const S* K, const S* L, S* D, S* pivot_terms, Solve&& solve) {
  Mask out = count(usable, D, pivot_terms);
  for (int c = 0; c < *count_; ++c) {
    null_column(c, L);
    error_[c] = residual(c, K);
    if (!can_join_) continue;
    const Mask depends = error_[c] <= S(tolerance::kRowLeft);
    each_of_column(c, [&](int l, int k) {
      if (out[l] && !depends[l]) joining_.add(l, k), listed_[l * most_ + c] = kJoined;
    });
  }
  if (joining_.any()) join(K, solve);
  for (int c = 0; c < *count_ && out.any(); ++c) out = out & refine(c, out, K, solve);
  out = make_orthogonal(out, K);
  S kept(0);  // more rows than coordinates cannot be independent
  for (int l = 0; l < W; ++l) kept.set(l, static_cast<double>(of_J_.size() - of(l).size()));
  out = out & (kept <= S(pattern_.nv));
  if (!out.any()) clear();
  return out;
}

/// Refines column c of N by solves with the kept rows. Returns the elements whose waiting row depends on the kept rows.
template <class S>
template <class Solve>
typename S::Mask WaitingRows<S>::refine(int c, Mask of, const S* K, Solve&& solve) {
  for (int step = 0; step <= tolerance::kNullColumnSteps; ++step) {
    const Mask open = of & (error_[c] > S(tolerance::kNullColumn));
    if (!open.any()) break;
    refine_column(c, open, solve);
    error_[c] = residual(c, K);
  }
  Mask depends = error_[c] <= S(tolerance::kRowLeft);
  for (int j : column(c)) depends = depends & (abs(N(c, j)) <= S(tolerance::kLargestEntry));
  return depends;
}

/// Joins independent waiting rows to the kept rows. Resets columns of N of the other waiting rows to z = 0.
template <class S>
template <class Solve>
void WaitingRows<S>::join(const S* K, Solve&& solve) {
  const auto diagonal = [&](int k) -> const S& { return K[pattern_.K.p[k + 1] - 1]; };
  const auto entries = [&](int l, int k, auto&& use) {
    for (const Entry& entry : of_row_.at(k)) use(entry.row, K[entry.slot][l]);
  };
  const auto terms = [&](int l, int k) {  // a row of mere rounding errors does not join
    double sum = terms_[k][l];
    if (!(entry_[k][l] > tolerance::kRank * row_size_[k][l])) sum = std::numeric_limits<double>::infinity();
    entries(l, k, [&](int i, double x) { sum += i > k ? x * x / diagonal(i)[l] : 0; });
    return sum;
  };
  const auto solve_refined = [&](const S* b, S* x) {  // refined once
    std::copy_n(b, rows_, x);
    solve(x);
    sparse::ldl_scheduled_residual(pattern_.K, as_scalar(K), as_scalar(x), as_scalar(b), as_scalar(x_.data()));
    solve(x_.data());
    for (int k = 0; k < rows_; ++k) x[k] += x_[k];
  };
  for (int l = 0; l < W; ++l) forget(l);
  joining_.factorize(entries, terms, solve_refined, [&](int l, int k) {
    const int c = count_[1 + l]++;
    listed_[l * most_ + c] = k;
    for (int j : of_J_) N(c, j).set(l, j == k);
  });
  *count_ = *std::max_element(count_ + 1, count_ + 1 + W);
  for (int c = 0; c < *count_; ++c) {
    list_column(c);
    error_[c] = residual(c, K);
  }
}

template <class S>
void WaitingRows<S>::forget(int lane) {  // removes an element's rows marked kJoined, and their columns of N
  int *const rows = listed_ + lane * most_, kept = 0;
  for (int c = 0; c < *count_; ++c) {
    const bool keep = c < count_[1 + lane] && rows[c] != kJoined;
    for (int j : of_J_) {
      const double entry = N(c, j)[lane];
      N(c, j).set(lane, 0);
      if (keep) N(kept, j).set(lane, entry);
    }
    if (keep) rows[kept++] = rows[c];
  }
  count_[1 + lane] = kept;
}

/// Counts the waiting rows, and removes their pivots. Returns the usable elements with at most most_ waiting rows.
template <class S>
typename S::Mask WaitingRows<S>::count(Mask usable, S* D, S* pivot_terms) {
  *waiting_ = S(0), *count_ = 0;
  for (int l = 0; l < W; ++l) {
    int& count = count_[1 + l];
    if (!usable[l]) count = 0;
    waiting_->set(l, count);
    count = std::min(count, static_cast<int>(most_));
    *count_ = std::max(*count_, count);
    for (int k : of(l)) {
      D[k].set(l, std::numeric_limits<double>::infinity());
      terms_[k].set(l, pivot_terms[k][l]);
      pivot_terms[k].set(l, 0);
    }
  }
  return usable & (*waiting_ <= S(static_cast<double>(most_)));
}

/// Sets column c of N to e_k - z for waiting row k, where L^T z = l_k over earlier rows of J; l_k: row k of L.
template <class S>
void WaitingRows<S>::null_column(int c, const S* L) {
  for (int k : of_J_) x_[k] = N(c, k) = S(0);
  each_of_column(c, [&](int l, int k) {
    N(c, k).set(l, 1);
    for (const Entry& entry : of_factor_.at(k)) x_[entry.row].set(l, L[entry.slot][l]);
  });
  for (std::size_t j = of_J_.size(); j-- > 0;) {
    const int k = of_J_[j];
    const S z = without_rounding(x_[k]);
    if (is_zero(z)) continue;
    N(c, k) -= z;
    for (const Entry& entry : of_factor_.at(k)) x_[entry.row] = subtract_product(L[entry.slot], z, x_[entry.row]);
  }
  list_column(c);
}

/// Sets left_ = J^T n for column n = c of N or Q. Returns its largest entry relative to the sizes of J's rows, or NaN.
template <class S>
S WaitingRows<S>::residual(int c, const S* K) {
  std::fill(left_.begin(), left_.end(), S(0));
  S size(0), largest(0), sum(0);
  for (int j : column(c)) {
    const S n = N(c, j);
    size = larger(abs(n) * row_size_[j], size);
    for (const Entry& entry : of_row_.at(j)) left_[entry.row] = multiply_add(n, K[entry.slot], left_[entry.row]);
  }
  for (const S& r : left_) largest = larger(abs(r), largest), sum += abs(r);
  return select(largest > S(0), largest / size, sum);
}

/// Corrects z of column c of N, in elements flagged in `open`, by K1^-1 times the residual left_ = J^T n. This is
/// needed because small pivots make null_column inaccurate.
template <class S>
template <class Solve>
void WaitingRows<S>::refine_column(int c, Mask open, Solve&& solve) {
  std::fill(x_.begin(), x_.end(), S(0));
  std::copy(left_.begin(), left_.end(), x_.begin());
  before_solve<1>(as_scalar(x_.data()));
  solve(x_.data());
  after_solve<1>(as_scalar(x_.data()));
  for (int k : of_J_) N(c, k) = without_rounding(N(c, k) - select(open, x_[k], S(0)));
  list_column(c);
}

/// Computes Q from N; orthogonal columns keep P accurate if N has large entries. Returns the elements of `of` whose
/// columns q satisfy J^T q = 0 up to rounding. Surplus columns of an element are zero.
template <class S>
typename S::Mask WaitingRows<S>::make_orthogonal(Mask of, const S* K) {
  for (int c = 0; c < *count_ && of.any(); ++c) {
    const int q = of_Q(c);
    std::copy_n(&N(c, 0), rows_, &N(q, 0));
    bool changed = false;
    for (int b = 0; b < 2 * c; ++b) {  // Gram-Schmidt twice, because of rounding
      const int other = of_Q(b % c);
      S sum(0);
      for (int j : column(other)) sum = multiply_add(N(other, j), N(q, j), sum);
      if (is_zero(sum)) continue;
      sum = sum * inverse_[b % c];
      for (int j : column(other)) N(q, j) = subtract_product(N(other, j), sum, N(q, j));
      changed = true;
    }
    list_column(q);
    S square(0);
    for (int j : column(q)) square = multiply_add(N(q, j), N(q, j), square);
    inverse_[c] = select(square > S(0), S(1) / square, S(0));
    if (changed) of = of & (residual(q, K) <= S(tolerance::kRowLeft));
  }
  return of;
}

}  // namespace manycontact::lanes
