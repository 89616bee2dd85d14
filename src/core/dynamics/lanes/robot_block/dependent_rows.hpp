#pragma once
// Redundant contact rows of robots in a SIMD batch: rank/dependent_rows.hpp for all elements at once, with the rows to
// drop given. `hold` checks for each element whether these are the rows that ldl_factor_dependent drops; where they are
// not, another system has to solve.

#include <limits>
#include <span>
#include <vector>

#include "../arrays.hpp"
#include "../checks.hpp"
#include "manycontact/rank/pivots.hpp"
#include "manycontact/sparse/ldl_kernels.hpp"

namespace manycontact::lanes {

template <class S>
class DependentRows {
 public:
  using Mask = typename S::Mask;
  explicit DependentRows(const BlockPlan& plan)
      : pattern_(*plan.pattern),
        dropped_(plan.dropped),
        nv_(plan.pattern->nv),
        rows_(plan.rows()),
        left_(nv_),
        x_(plan.pattern->size()),
        t_(dropped_.size()) {}

  /// Memory to project so many columns at a time.
  void reserve(int columns) { t_.resize(std::max(t_.size(), dropped_.size() * columns)); }

  /// Sets the memory of the current robots' numbers: BlockPlan::dependence_size of each.
  void use(double* memory) {
    const std::size_t rows = rows_ - nv_, count = dropped_.size();
    row_terms_ = reinterpret_cast<S*>(memory) - nv_;
    row_size_ = row_terms_ + rows;
    null_component_ = row_size_ + rows;
    N_ = null_component_ + rows;
    gram_ = N_ + nv_ + count * rows;
    columns_ = reinterpret_cast<int*>(gram_ + count * count);
  }
  /// The size that row k of J, in K's order, is judged relative to (rank/row_size.hpp); to be set before `hold`.
  S& row_size(int k) const { return row_size_[k]; }
  /// The largest term that its a0 is computed from (contact_drift), which its inconsistency is judged relative to.
  S& row_terms(int k) const { return row_terms_[k]; }
  /// The part of row k that project_out kept.
  const S& null_component(int k) const { return null_component_[k]; }

  /// Before K is factorized: the rows dropped as if they were damped beyond all numbers, which leaves the others as
  /// they are without them ...
  void damp(S* K) const {
    for (int k : dropped_) K[diagonal(k)] = S(-tolerance::kDroppedDamping);
  }
  /// ... and after: K as it was, without pivots of these.
  void undamp(S* K, S* D, S* pivot_terms) const {
    for (int k : dropped_) {
      K[diagonal(k)] = pivot_terms[k] = S(0);
      D[k] = S(std::numeric_limits<double>::infinity());
    }
  }

  /// Returns where ldl_factor_dependent drops these rows and no others, by a margin, and they depend on the rows kept.
  /// Makes the null space and its projector. solve(x): x <- K_kept^-1 x, of all the
  /// pattern's rows.
  template <class Solve>
  Mask hold(const S* K, const S* L, const S* D, const S* pivot_terms, Solve&& solve) {
    Mask out = same_rows(K, L, D, pivot_terms);
    for (std::size_t c = 0; c < dropped_.size(); ++c) {
      null_column(c, L);
      S error = residual(c, K);
      for (int step = 0; step < tolerance::kNullColumnSteps; ++step) {
        const Mask open = out & (error > S(tolerance::kNullColumn));
        if (!open.any()) break;
        refine_column(c, open, solve);
        error = residual(c, K);
      }
      out = out & (error <= S(tolerance::kRowLeft));
      for (int j : column(c)) out = out & (abs(N(c, j)) <= S(tolerance::kLargestEntry));
    }
    form_gram();
    return out;
  }

  /// Computes the sizes that residuals of all rows are judged relative to (rank::scale_of_dependent), into `judged`.
  void scale_of_dependent(const S* scale, S* judged) {
    std::copy_n(scale, rows_, judged);
    for (std::size_t c = 0; c < dropped_.size(); ++c) {
      S sum(0);
      for (int j : column(c)) sum = multiply_add(abs(N(c, j)), scale[j], sum);
      judged[dropped_[c]] = sum;
    }
  }

  /// x -= P x, of the rows of J; P x into null_component where `keep`.
  void project_out(S* x, bool keep = false) {
    project_out<1>(as_scalar(x));
    if (!keep) return;
    std::fill(null_component_ + nv_, null_component_ + rows_, S(0));
    for (std::size_t a = 0; a < dropped_.size(); ++a)
      for (int j : column(a)) null_component_[j] = multiply_add(N(a, j), t_[a], null_component_[j]);
  }
  /// x -= P x of C columns, row after row.
  template <int C, class V>
  void project_out(V* x) {
    subtract_null_component<C>(x, x);
  }
  /// x -= P y in the same way.
  template <int C, class V>
  void subtract_null_component(const V* y, V* x) {
    using Row = sparse::kernel::Tile<V, C>;
    V* t = as_scalar(t_.data());
    for (std::size_t a = 0; a < dropped_.size(); ++a) {
      Row sum = Row::all(V(0));
      for (int j : column(a)) sum.add(*as_scalar(&N(a, j)), y + std::ptrdiff_t{j} * C);
      sum.store(t + a * C);
    }
    solve_gram<C>(t);
    for (std::size_t a = 0; a < dropped_.size(); ++a) {
      const Row of_column = Row::load(t + a * C);
      for (int j : column(a)) {
        Row row = Row::load(x + std::ptrdiff_t{j} * C);
        row.subtract(*as_scalar(&N(a, j)), of_column);
        row.store(x + std::ptrdiff_t{j} * C);
      }
    }
  }

 private:
  int diagonal(int k) const { return pattern_.K.p[k + 1] - 1; }
  S& N(std::size_t c, int row) { return N_[c * static_cast<std::size_t>(rows_ - nv_) + row]; }
  /// Rows of column c of N that are not zero in any element, the dropped row first; their number precedes them.
  int* counted(std::size_t c) { return columns_ + c * static_cast<std::size_t>(rows_ - nv_ + 1); }
  std::span<const int> column(std::size_t c) { return {counted(c) + 1, static_cast<std::size_t>(*counted(c))}; }
  void begin_column(std::size_t c) { counted(c)[0] = 1, counted(c)[1] = dropped_[c]; }

  /// The largest entry of a row of J.
  S largest_entry(const S* K, int k) const {
    S size(0);
    for (int p = pattern_.K.p[k]; p < pattern_.K.p[k + 1]; ++p)
      if (pattern_.K.i[p] < nv_) size = larger(abs(K[p]), size);
    return size;
  }

  /// Whether ldl_factor_dependent would drop these rows, by a margin (see kkt/factor/dependent_rows.cpp).
  Mask same_rows(const S* K, const S* L, const S* D, const S* pivot_terms) const {
    Mask good = S(0) <= S(0);
    rank::PassedOn<S> passed_on;
    auto next = dropped_.begin();
    for (int k = 0; k < rows_; ++k) {
      if (next != dropped_.end() && *next == k) {
        ++next;
        const rank::Pivot<S> rest = rest_of(k, K, L, D);
        good = good & (rest.terms <= S(std::numeric_limits<double>::max())) &
               (select(rank::is_left(rest, 1 / tolerance::kMargin), S(1), S(0)) <= S(0));
        continue;
      }
      const bool of_M = k < nv_;
      const rank::Pivot<S> pivot{of_M, D[k], pivot_terms[k], of_M ? K[diagonal(k)] : largest_entry(K, k),
                                 of_M ? S(0) : row_size_[k]};
      good = good & passed_on.accepts(of_M, abs(pivot.d) / (S(tolerance::kMargin) * pivot.terms)) &
             rank::is_left(pivot, tolerance::kMargin) & rank::has_its_sign(pivot);
    }
    return good;
  }
  /// The pivot that K's own row would have in place of row k, which is dropped.
  rank::Pivot<S> rest_of(int k, const S* K, const S* L, const S* D) const {
    const sparse::LdlSymbolic& s = pattern_.ldl;
    rank::Pivot<S> rest{false, S(0), S(0), largest_entry(K, k), row_size_[k]};
    for (int p = s.Rp[k]; p < s.Rp[k + 1]; ++p) {
      const S l = L[s.Rk[p]], d = D[s.Rj[p]];
      const S term = select(abs(d) <= S(std::numeric_limits<double>::max()), l * l * d, S(0));
      rest.d -= term, rest.terms += abs(term);
    }
    return rest;
  }

  /// L^T z = l_k over the rows of J, and the column e_k - z of N.
  void null_column(std::size_t c, const S* L) {
    const sparse::LdlSymbolic& s = pattern_.ldl;
    const int k = dropped_[c];
    std::fill(x_.begin() + nv_, x_.begin() + k, S(0));
    for (int p = s.Rp[k]; p < s.Rp[k + 1]; ++p)
      if (s.Rj[p] >= nv_) x_[s.Rj[p]] = L[s.Rk[p]];
    begin_column(c);
    N(c, k) = S(1);
    for (int j = k - 1; j >= nv_; --j) {
      const S z = keep_entry(c, j, x_[j]);
      if ((abs(z) <= S(0)).all()) continue;
      for (int p = s.Rp[j + 1] - 1; p >= s.Rp[j] && s.Rj[p] >= nv_; --p)
        x_[s.Rj[p]] = subtract_product(L[s.Rk[p]], z, x_[s.Rj[p]]);
    }
  }
  /// Stores entry j of the column, -z, where any element has one; returns z as stored.
  S keep_entry(std::size_t c, int j, S z) {
    z = select(abs(z) <= S(tolerance::kNullEntry), S(0), z);
    if ((abs(z) <= S(0)).all()) return z;
    int* rows = counted(c);
    rows[++rows[0]] = j;
    N(c, j) = -z;
    return z;
  }

  /// left <- J_k - sum_j z_j J_j; returns its largest entry relative to the sizes of the rows. NaN where any is.
  S residual(std::size_t c, const S* K) {
    std::fill(left_.begin(), left_.end(), S(0));
    S size(0), largest(0), sum(0);
    for (int j : column(c)) {
      const S n = N(c, j);
      size = larger(abs(n) * row_size_[j], size);
      for (int p = pattern_.K.p[j]; p < pattern_.K.p[j + 1] && pattern_.K.i[p] < nv_; ++p)
        left_[pattern_.K.i[p]] = multiply_add(n, K[p], left_[pattern_.K.i[p]]);
    }
    for (const S& r : left_) largest = larger(abs(r), largest), sum += abs(r);
    return select(largest > S(0), largest / size, sum);
  }

  /// z += K_kept^-1 of what z leaves, in the elements that are open: where the pivots kept were too small for l_k to be
  /// accurate.
  template <class Solve>
  void refine_column(std::size_t c, Mask open, Solve&& solve) {
    std::fill(x_.begin(), x_.end(), S(0));
    std::copy(left_.begin(), left_.end(), x_.begin());
    solve(x_.data());
    const int k = dropped_[c];
    for (int j = nv_; j < k; ++j) x_[j] = select(open, x_[j], S(0));
    for (int j : column(c).subspan(1)) x_[j] -= N(c, j);
    begin_column(c);
    for (int j = k - 1; j >= nv_; --j) (void)keep_entry(c, j, x_[j]);
  }

  /// The factor of N^T N.
  void form_gram() {
    const std::size_t n = dropped_.size();
    for (std::size_t a = 0; a < n; ++a) {
      std::fill(x_.begin() + nv_, x_.begin() + rows_, S(0));
      for (int j : column(a)) x_[j] = N(a, j);
      for (std::size_t b = 0; b <= a; ++b) {
        S sum(0);
        for (int j : column(b)) sum = multiply_add(N(b, j), x_[j], sum);
        gram_[a * n + b] = sum;
      }
    }
    for (std::size_t a = 0; a < n; ++a) {  // L D L^T in its place, the inverse of D on the diagonal
      S* row = gram_ + a * n;
      for (std::size_t b = 0; b < a; ++b)
        for (std::size_t c = 0; c < b; ++c) row[b] = subtract_product(row[c], gram_[b * n + c], row[b]);
      for (std::size_t b = 0; b < a; ++b) {
        const S ld = row[b];
        row[b] = ld * gram_[b * n + b];
        row[a] = subtract_product(row[b], ld, row[a]);
      }
      row[a] = S(1) / row[a];
    }
  }
  /// t <- (N^T N)^-1 t of C columns.
  template <int C, class V>
  void solve_gram(V* t) {
    using Row = sparse::kernel::Tile<V, C>;
    const int n = static_cast<int>(dropped_.size());
    const auto row = [&](int a, int from, int to, auto&& l, const V& scale) {
      Row sum = Row::load(t + a * C).times(scale);
      for (int b = from; b < to; ++b) sum.subtract(l(b), Row::load(t + b * C));
      sum.store(t + a * C);
    };
    const V* gram = as_scalar(gram_);
    for (int a = 0; a < n; ++a)
      row(
          a, 0, a, [&](int b) { return gram[a * n + b]; }, V(1));
    for (int a = n; a-- > 0;)
      row(
          a, a + 1, n, [&](int b) { return gram[b * n + a]; }, gram[a * n + a]);
  }

  const KktPattern& pattern_;
  const std::vector<int>& dropped_;
  int nv_, rows_;
  S* row_terms_;
  S *row_size_, *null_component_;  // one entry per row of K, from nv on
  S *N_, *gram_;                   // N by columns, as these; of the factor of N^T N
  int* columns_;
  std::vector<S> left_, x_, t_;  // t: of each column of N, what is projected at a time
};

}  // namespace manycontact::lanes
