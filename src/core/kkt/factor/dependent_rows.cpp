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

  // A row of J without a plain pivot waits (tolerance::kWaits). J's rows themselves decide whether it depends on the
  // others: their remainder must be rounding errors. In between, the dense reference solver decides.
  Reason factorize(const KktMatrix& K, FactorScratch& scratch) override {
    if (ldl_.pattern != K.pattern) take(K.pattern);
    const KktPattern& p = *ldl_.pattern;
    scratch.scale.resize(std::max<std::size_t>(scratch.scale.size(), K.size()));
    scratch.ldl.reserve(p.ldl);
    take_sizes(K, scratch);
    const std::size_t most = p.nc <= tolerance::kFewRows ? p.nc : tolerance::kMostWaiting;
    const int done = rank::ldl_factor_dependent(p.K, p.ldl, K.values.data(), of_M_, tolerance::kWaits, row_size_.data(),
                                                most, scratch.ldl, ldl_.L.data(), ldl_.D.data(), dependence_);
    if (done < p.size())
      return of_M_[done]                         ? Reason::kSingularInertia
             : dependence_.dropped.size() < most ? Reason::kWrongInertia
                                                 : Reason::kSmallPivot;
    growth_ = growth(K, scratch.scale);
    const bool found = rank::find_dependence(p.K, p.ldl, K.values.data(), of_M_, row_size_.data(), ldl_.L.data(),
                                             ldl_.D.data(), dependence_);
    return found ? Reason::kNone : Reason::kSmallPivot;
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
    row_size_.assign(pattern->size(), 0.0);
    of_M_.resize(pattern->size());
    for (int k = 0; k < pattern->size(); ++k) of_M_[k] = pattern->perm[k] < pattern->nv;
    ldl_.take(pattern, true);
  }

  void take_sizes(const KktMatrix& K, const FactorScratch& scratch) {
    const KktPattern& p = *ldl_.pattern;
    for (int k = 0; k < p.nc; ++k) row_size_[p.iperm[p.nv + k]] = internal::size_of_row(K, scratch, k);
  }

  void solve_kept(double* x) {
    rank::solve_kept(dependence_, x, [this](double* y) { ldl_.solve(y); });
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
  std::vector<char> of_M_;        // flag of each row of K, in its order: it is one of M's
  std::vector<double> row_size_;  // size of each row of J, in K's order; unused in M's rows
  rank::DependentRows dependence_;
  double growth_ = 1;
};

}  // namespace

std::unique_ptr<Factor> make_dependent_rows_factor() { return std::make_unique<DependentRowsFactor>(); }

}  // namespace manycontact
