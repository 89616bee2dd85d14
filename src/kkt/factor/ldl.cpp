#include "manycontact/kkt/factor/factors.hpp"
#include "pivots.hpp"

namespace manycontact {

namespace {

class LdlFactor final : public Factor {
 public:
  Method method() const override { return Method::kSparseLdl; }

  Reason factorize(const KktMatrix& K, FactorScratch& scratch) override {
    pattern_ = K.pattern;
    const sparse::LdlSymbolic& symbolic = pattern_->ldl;
    L_.resize(symbolic.nonzeros());
    D_.resize(K.size());
    scratch.scale.resize(std::max<std::size_t>(scratch.scale.size(), K.size()));
    const double* Kx = K.values.data();
    if (sparse::ldl_factor(pattern_->K, symbolic, Kx, scratch.ldl, L_.data(), D_.data()) != K.size())
      return Reason::kZeroPivot;
    const double ratio =
        sparse::smallest_pivot_ratio(pattern_->K, symbolic, Kx, L_.data(), D_.data(), scratch.scale.data());
    growth_ = internal::growth_of(K, scratch.scale.data());
    return internal::judge_pivots(*pattern_, D_.data(), ratio);
  }

  void solve(double* x) override { sparse::ldl_solve(pattern_->ldl, L_.data(), D_.data(), x); }

  void solve_panel(double* X, int ld, int first, int cols, char* nonzero) override {
    sparse::ldl_solve_panel(pattern_->ldl, L_.data(), D_.data(), pattern_->perm.data(), X, ld, first, cols, nonzero);
  }

  double growth() const override { return growth_; }
  int rank() const override { return pattern_->nc; }
  int nonzeros() const override { return pattern_->ldl.nonzeros() + pattern_->size(); }

 private:
  std::shared_ptr<const KktPattern> pattern_;
  std::vector<double> L_, D_;
  double growth_ = 1;
};

}  // namespace

std::unique_ptr<Factor> make_ldl_factor() { return std::make_unique<LdlFactor>(); }

}  // namespace manycontact
