#include "manycontact/sparse/dependent_rows.hpp"

#include "manycontact/kkt/factor/factors.hpp"
#include "manycontact/sparse/tolerances.hpp"
#include "pivots.hpp"

namespace manycontact {

namespace {

class DependentRowsFactor final : public Factor {
 public:
  Method method() const override { return Method::kSparseLdl; }

  // A row of J with less than kPivotLeft left of its pivot may depend on the others (below 3e-6 of its length it does
  // not point elsewhere). Whether it does in truth, J's rows themselves tell, far more sharply: what is left of them
  // must be rounding; in between, the oracle decides.
  Reason factorize(const KktMatrix& K, FactorScratch& scratch) override {
    pattern_ = K.pattern;
    const KktPattern& p = *pattern_;
    L_.resize(p.ldl.nonzeros());
    D_.resize(p.size());
    const double* Kx = K.values.data();
    const int done =
        sparse::ldl_factor_dependent(p.K, p.ldl, Kx, p.nv, tolerance::kPivotLeft, tolerance::kRank * K.row_size,
                                     scratch.ldl, L_.data(), D_.data(), dependence_);
    if (done != p.size()) return done < p.nv ? Reason::kSingularInertia : Reason::kWrongInertia;
    growth_ = growth(K, scratch.scale);
    sparse::find_null_space(p.K, p.ldl, Kx, p.nv, K.row_size, L_.data(), D_.data(), dependence_);
    return dependence_.believable() ? Reason::kNone : Reason::kSmallPivot;
  }

  // (I - P) K_kept^-1 (I - P) x
  void solve(double* x) override {
    sparse::project_out(dependence_, x);
    sparse::ldl_solve(pattern_->ldl, L_.data(), D_.data(), x);
    sparse::project_out(dependence_, x);
  }

  void solve_panel(double* X, int ld, int first, int cols, char* nonzero) override {
    const int* perm = pattern_->perm.data();
    const bool dropped = !dependence_.dropped.empty();
    if (dropped) {
      sparse::project_out_panel(dependence_, perm, X, ld, first, cols);
      std::fill(nonzero, nonzero + pattern_->size(), 1);  // the projection spreads over contacts
    }
    sparse::ldl_solve_panel(pattern_->ldl, L_.data(), D_.data(), perm, X, ld, first, cols, nonzero);
    if (dropped) sparse::project_out_panel(dependence_, perm, X, ld, first, cols);
  }

  double growth() const override { return growth_; }
  int rank() const override { return pattern_->nc - static_cast<int>(dependence_.dropped.size()); }
  void dependent_rows(std::vector<int>& rows) const override {
    rows.clear();
    for (int k : dependence_.dropped) rows.push_back(pattern_->perm[k] - pattern_->nv);
  }
  void project_out(double* y, double* null_part) override { sparse::project_out(dependence_, y, null_part); }
  void project_out_panel(double* X, int ld, int cols) override {
    sparse::project_out_panel(dependence_, pattern_->perm.data(), X, ld, 0, cols);
  }

  int nonzeros() const override { return pattern_->ldl.nonzeros() + pattern_->size(); }

 private:
  std::shared_ptr<const KktPattern> pattern_;
  std::vector<double> L_, D_;
  // As growth_of, without the rows dropped, of which D is infinite.
  double growth(const KktMatrix& K, std::vector<double>& scale) const {
    const sparse::LdlSymbolic& s = pattern_->ldl;
    scale.resize(std::max<std::size_t>(scale.size(), K.size()));
    std::fill_n(scale.begin(), K.size(), 0.0);
    for (int j = 0; j < s.n; ++j)
      for (int k = s.Lp[j]; std::isfinite(D_[j]) && k < s.Lp[j + 1]; ++k)
        scale[s.Li[k]] += L_[k] * L_[k] * std::abs(D_[j]);
    return std::max(1.0, internal::growth_of(K, scale.data()));
  }

  sparse::DependentRows dependence_;
  double growth_ = 1;
};

}  // namespace

std::unique_ptr<Factor> make_dependent_rows_factor() { return std::make_unique<DependentRowsFactor>(); }

}  // namespace manycontact
