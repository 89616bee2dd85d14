#include <algorithm>

#include "ldl_numbers.hpp"
#include "manycontact/kkt/factor/factors.hpp"
#include "manycontact/sparse/ldl_panel_kernels.hpp"
#include "manycontact/sparse/panel_kernels.hpp"
#include "pivots.hpp"

namespace manycontact {

namespace {

class LdlFactor final : public Factor {
 public:
  explicit LdlFactor(Method method) : method_(method) {}
  Method method() const override { return method_; }

  Reason factorize(const KktMatrix& K, FactorScratch& scratch) override {
    if (ldl_.pattern != K.pattern) ldl_.take(K.pattern, method_ == Method::kSparseLdl);
    if (!ldl_.factor(K.values.data(), scratch)) return Reason::kZeroPivot;
    growth_ = internal::growth_of(K, scratch.scale.data());
    const Reason reason = internal::judge_pivots(K, ldl_.L.data(), ldl_.D.data(), scratch);
    // Growth beyond all numbers: no residual of a solve vouches for other right-hand sides.
    return reason == Reason::kNone && !std::isfinite(growth_) ? Reason::kSmallPivot : reason;
  }

  void solve(double* x) override { ldl_.solve(x); }
  void solve_panel(double* X, int ld, int first, int cols, char* nonzero) override {
    ldl_.solve_panel(X, ld, first, cols, nonzero);
  }
  bool refines_panels() const override { return ldl_.schedule; }
  void solve_panel_refined(const KktMatrix& K, double* X, int ld, int first, int cols, char* nonzero) override {
    sparse::panel_kernels().solve_refined(*ldl_.schedule, ldl_.pattern->K, K.values.data(), ldl_.L.data(),
                                          ldl_.D.data(), ldl_.pattern->perm.data(), X, ld, first, cols, nonzero,
                                          ldl_.work());
  }
  double panel_error(const KktMatrix& K) override {
    double *of_factor = ldl_.work(), *of_K = of_factor + ldl_.D.size();
    sparse::ldl_row_sums(ldl_.pattern->K, K.values.data(), ldl_.pattern->ldl, ldl_.L.data(), ldl_.D.data(), of_factor,
                         of_K);
    return sparse::ldl_rounding(ldl_.pattern->ldl) * *std::max_element(of_factor, of_K) /
           *std::max_element(of_K, of_K + ldl_.D.size());
  }

  double growth() const override { return growth_; }
  int rank() const override { return ldl_.pattern->nc; }
  int nonzeros() const override { return ldl_.nonzeros(); }

 private:
  Method method_;
  internal::LdlNumbers ldl_;
  double growth_ = 1;
};

}  // namespace

std::unique_ptr<Factor> make_ldl_factor(Method method) { return std::make_unique<LdlFactor>(method); }

}  // namespace manycontact
