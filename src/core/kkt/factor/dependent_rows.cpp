#include "manycontact/rank/dependent_rows.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

#include "ldl_numbers.hpp"
#include "manycontact/kkt/factor/factors.hpp"
#include "manycontact/sparse/panel_kernels.hpp"
#include "manycontact/sparse/tolerances.hpp"
#include "pivots.hpp"

namespace manycontact {

namespace {

class DependentRowsFactor final : public Factor {
 public:
  Method method() const override { return Method::kSparseLdl; }

  // A row of J with less than kPivotLeft left of its pivot may depend on the others (below 3e-6 of its length it has no
  // direction of its own). J's rows themselves decide far more sharply whether it does: their remainder must be
  // rounding errors; in between, the dense reference solver decides.
  Reason factorize(const KktMatrix& K, FactorScratch& scratch) override {
    if (ldl_.pattern != K.pattern) take(K.pattern);
    dependence_.waiting.rows.clear();
    dependence_.waiting.joined = 0;
    scratch.scale.resize(std::max<std::size_t>(scratch.scale.size(), K.size()));
    scratch.ldl.reserve(ldl_.pattern->ldl);
    take_sizes(K, scratch);
    if (const Reason reason = drop_in_order(K, scratch); reason != Reason::kNone) return reason;
    return dependence_.accepted() || let_rows_wait(K, scratch) ? Reason::kNone : Reason::kSmallPivot;
  }

  // (I - P) K_kept^-1 (I - P) x
  void solve(double* x) override {
    rank::project_out(dependence_, x);
    solve_kept(x);
    rank::project_out(dependence_, x);
  }

  void correct(double* r) override {
    solve_kept(r);
    rank::project_out(dependence_, r);
  }
  double backward_error(std::span<const double> r, std::span<const double> scale) override {
    return sparse::componentwise_backward_error(r, rank::scale_of_dependent(dependence_, scale));
  }

  void solve_panel(double* X, int ld, int first, int cols, char* nonzero) override {
    const int* perm = ldl_.pattern->perm.data();
    const bool dropped = !dependence_.dropped.empty();
    if (dropped) rank::project_out_panel(dependence_, perm, X, ld, first, cols, nonzero);
    const bool joined = dependence_.waiting.joined > 0;
    if (joined) rank::before_solve(dependence_.waiting, perm, X + first, ld, cols);
    ldl_.solve_panel(X, ld, first, cols, nonzero);
    if (joined) rank::after_solve(dependence_.waiting, perm, X + first, ld, cols);
    if (dropped) rank::project_out_panel(dependence_, perm, X, ld, first, cols);
  }

  double growth() const override { return growth_; }
  int rank() const override { return ldl_.pattern->nc - static_cast<int>(dependence_.dropped.size()); }
  void dependent_rows(std::vector<int>& rows) const override {
    rows.clear();
    for (int k : dependence_.dropped) rows.push_back(ldl_.pattern->perm[k] - ldl_.pattern->nv);
  }
  void project_out(double* y, double* null_component) override { rank::project_out(dependence_, y, null_component); }
  void project_out_panel(double* X, int ld, int cols) override {
    rank::project_out_panel(dependence_, ldl_.pattern->perm.data(), X, ld, 0, cols);
  }

  void null_space_rows(std::span<char> rows) const override {
    std::fill(rows.begin(), rows.end(), 0);
    for (int k : dependence_.Ni) rows[ldl_.pattern->perm[k] - ldl_.pattern->nv] = 1;
  }

  // Coefficients z of the null space enter by their square; sums go over as many as a cluster has.
  double projector_error() const override {
    const double z = dependence_.largest_projected, sums = dependence_.largest_cluster;
    return tolerance::kBoundRounding * std::numeric_limits<double>::epsilon() * (1 + z * z) * std::sqrt(sums);
  }

  int nonzeros() const override { return ldl_.nonzeros(); }

 private:
  void take(const std::shared_ptr<const KktPattern>& pattern) {
    dependence_.dropped.clear();
    penalised_.resize(pattern->K.nonzeros());
    row_size_.assign(pattern->size(), 0.0);
    of_M_.resize(pattern->size());
    for (int k = 0; k < pattern->size(); ++k) of_M_[k] = pattern->perm[k] < pattern->nv;
    ldl_.take(pattern, true);
  }

  void take_sizes(const KktMatrix& K, const FactorScratch& scratch) {
    const KktPattern& p = *ldl_.pattern;
    for (int k = 0; k < p.nc; ++k) row_size_[p.iperm[p.nv + k]] = internal::size_of_row(K, scratch, k);
  }

  // Rows that depend on those before them, and the null space.
  Reason drop_in_order(const KktMatrix& K, FactorScratch& scratch) {
    if (drop_again(K, scratch)) return Reason::kNone;  // the rows dropped for the K before
    if (const Reason reason = drop(K, scratch); reason != Reason::kNone) return reason;
    if (ldl_.schedule && !dependence_.dropped.empty()) {
      if (drop_again(K, scratch)) return Reason::kNone;  // numbers must not depend on what was before
      if (const Reason reason = drop(K, scratch); reason != Reason::kNone) return reason;
    }
    growth_ = growth(K, scratch.scale);
    find_null_space(K);
    return Reason::kNone;
  }

  // Once more, and rows without a plain pivot wait. False where rounding hides which rows depend.
  bool let_rows_wait(const KktMatrix& K, FactorScratch& scratch) {
    const KktPattern& p = *ldl_.pattern;
    if (drop(K, scratch, tolerance::kWaits) != Reason::kNone) return false;
    growth_ = growth(K, scratch.scale);
    find_null_space(K);
    if (!rank::let_rows_wait(p.K, p.ldl, K.values.data(), of_M_, row_size_.data(), ldl_.L.data(), ldl_.D.data(),
                             dependence_))
      return false;
    find_null_space(K);
    return dependence_.accepted();
  }

  void solve_kept(double* x) {
    rank::solve_kept(dependence_, x, [this](double* y) { ldl_.solve(y); });
  }

  Reason drop(const KktMatrix& K, FactorScratch& scratch, double margin = 1) {
    const KktPattern& p = *ldl_.pattern;
    const int done = rank::ldl_factor_dependent(p.K, p.ldl, K.values.data(), of_M_, margin, row_size_.data(),
                                                scratch.ldl, ldl_.L.data(), ldl_.D.data(), dependence_);
    if (done == p.size()) return Reason::kNone;
    return of_M_[done] ? Reason::kSingularInertia : Reason::kWrongInertia;
  }

  // The factor without the rows dropped: as if they were damped beyond all numbers, which leaves the others as they are
  // without them.
  void factorize_kept(const KktMatrix& K, FactorScratch& scratch) {
    constexpr double kDamping = tolerance::kDroppedDamping, kInfinite = std::numeric_limits<double>::infinity();
    std::copy(K.values.begin(), K.values.end(), penalised_.begin());
    for (int k : dependence_.dropped) penalised_[ldl_.pattern->K.p[k + 1] - 1] = -kDamping;
    (void)ldl_.factor(penalised_.data(), scratch);  // a failure leaves pivots that are not finite
    for (int k : dependence_.dropped) ldl_.D[k] = kInfinite, scratch.scale[k] = 0;
  }

  // The rows dropped last once more, by the compiled schedule. False where `drop` would drop others.
  bool drop_again(const KktMatrix& K, FactorScratch& scratch) {
    if (!ldl_.schedule || dependence_.dropped.empty()) return false;
    factorize_kept(K, scratch);
    if (!drops_the_same(K, scratch)) return false;
    growth_ = std::max(1.0, internal::growth_of(K, scratch.scale.data()));
    find_null_space(K);
    return true;
  }
  // Whether `drop` would drop the same rows, by the pivots of all; those of the rows dropped are what K's own would be.
  // There is a margin: both factors round differently, and where that decides, `drop` must.
  bool drops_the_same(const KktMatrix& K, FactorScratch& scratch) const {
    return kept_are_sound(K, scratch, tolerance::kMargin) &&
           std::all_of(dependence_.dropped.begin(), dependence_.dropped.end(), [&](int k) {
             const auto [d, terms] = rest_of(k, K.values[ldl_.pattern->K.p[k + 1] - 1]);
             return std::isfinite(terms) && !rank::is_left(pivot_of(K, k, d, terms), 1 / tolerance::kMargin);
           });
  }
  bool kept_are_sound(const KktMatrix& K, FactorScratch& scratch, double margin) const {
    const std::vector<double>& terms = scratch.scale;
    auto dropped = dependence_.dropped.begin();
    for (int k = 0; k < K.size(); ++k) {
      if (dropped != dependence_.dropped.end() && *dropped == k) {
        ++dropped;
        continue;
      }
      const rank::Pivot<double> pivot = pivot_of(K, k, ldl_.D[k], terms[k]);
      if (!rank::is_left(pivot, margin) || !rank::has_its_sign(pivot)) return false;
    }
    const auto of_M = [this](int k) { return of_M_[k] != 0; };
    return !rank::any_pivot_is_rounding(ldl_.pattern->ldl, ldl_.L.data(), ldl_.D.data(), terms.data(), margin, of_M,
                                        internal::noise_of(K.size(), scratch));
  }
  // A pivot of these terms, with its row's own entries.
  rank::Pivot<double> pivot_of(const KktMatrix& K, int k, double d, double terms) const {
    const sparse::UpperCsc& A = ldl_.pattern->K;
    if (of_M_[k]) return {true, d, terms, K.values[A.p[k + 1] - 1]};
    double own = 0;
    for (int p = A.p[k]; p < A.p[k + 1]; ++p) own = std::max(own, std::abs(K.values[p]));
    return {false, d, terms, own, row_size_[k]};
  }
  // The remainder of row k's entry on the diagonal after L, and the sizes of the terms.
  std::pair<double, double> rest_of(int k, double d) const {
    const sparse::LdlSymbolic& s = ldl_.pattern->ldl;
    double terms = std::abs(d);
    for (int p = s.Rp[k]; p < s.Rp[k + 1]; ++p) {
      if (std::isinf(ldl_.D[s.Rj[p]])) continue;
      const double l = ldl_.L[s.Rk[p]], t = l * l * ldl_.D[s.Rj[p]];
      d -= t, terms += std::abs(t);
    }
    return {d, terms};
  }
  void find_null_space(const KktMatrix& K) {
    const KktPattern& p = *ldl_.pattern;
    rank::find_null_space(p.K, p.ldl, K.values.data(), of_M_, row_size_.data(), ldl_.L.data(), ldl_.D.data(),
                          dependence_);
  }

  // Computes growth_of without the dropped rows, whose D is infinite.
  double growth(const KktMatrix& K, std::vector<double>& scale) const {
    const sparse::LdlSymbolic& s = ldl_.pattern->ldl;
    std::fill_n(scale.begin(), K.size(), 0.0);
    for (int j = 0; j < s.n; ++j)
      for (int k = s.Lp[j]; std::isfinite(ldl_.D[j]) && k < s.Lp[j + 1]; ++k)
        scale[s.Li[k]] += ldl_.L[k] * ldl_.L[k] * std::abs(ldl_.D[j]);
    return std::max(1.0, internal::growth_of(K, scale.data()));
  }

  internal::LdlNumbers ldl_;
  std::vector<char> of_M_;         // flag of each row of K, in its order: it is one of M's
  std::vector<double> penalised_;  // K, the rows dropped damped
  std::vector<double> row_size_;   // size of each row of J, in K's order; unused in M's rows
  rank::DependentRows dependence_;
  double growth_ = 1;
};

}  // namespace

std::unique_ptr<Factor> make_dependent_rows_factor() { return std::make_unique<DependentRowsFactor>(); }

}  // namespace manycontact
