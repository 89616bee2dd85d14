#include <algorithm>

#include "manycontact/kkt/factor/factors.hpp"
#include "manycontact/sparse/ldl_panel_kernels.hpp"
#include "manycontact/sparse/panel_kernels.hpp"
#include "panel_memory.hpp"
#include "pivots.hpp"

namespace manycontact {

namespace {

class LdlFactor final : public Factor {
 public:
  explicit LdlFactor(Method method) : method_(method) {}
  Method method() const override { return method_; }

  Reason factorize(const KktMatrix& K, FactorScratch& scratch) override {
    if (pattern_ != K.pattern) take(K.pattern);
    if (scratch.scale.size() < D_.size()) scratch.scale.resize(D_.size());
    const double* Kx = K.values.data();
    double* scale = scratch.scale.data();
    double ratio = 0;
    if (schedule_) {
      sparse::panel_kernels().factor(*schedule_, Kx, L_.data(), D_.data(), scale);
      ratio = sparse::smallest_pivot_ratio(K.size(), D_.data(), scale);
    } else {
      if (sparse::ldl_factor(pattern_->K, pattern_->ldl, Kx, scratch.ldl, L_.data(), D_.data()) != K.size())
        return Reason::kZeroPivot;
      ratio = sparse::smallest_pivot_ratio(pattern_->K, pattern_->ldl, Kx, L_.data(), D_.data(), scale);
    }
    growth_ = internal::growth_of(K, scale);
    const Reason reason = internal::judge_pivots(*pattern_, D_.data(), ratio);
    // Growth beyond all numbers: no residual of a solve vouches for other right-hand sides.
    return reason == Reason::kNone && !std::isfinite(growth_) ? Reason::kSmallPivot : reason;
  }

  void solve(double* x) override {
    if (schedule_)
      sparse::panel_kernels().solve_vector(*schedule_, L_.data(), D_.data(), x);
    else
      sparse::ldl_solve(pattern_->ldl, L_.data(), D_.data(), x);
  }

  void solve_panel(double* X, int ld, int first, int cols, char* nonzero) override {
    const int* perm = pattern_->perm.data();
    if (!schedule_)
      return sparse::ldl_solve_panel(pattern_->ldl, L_.data(), D_.data(), perm, X, ld, first, cols, nonzero);
    sparse::panel_kernels().solve(*schedule_, L_.data(), D_.data(), perm, X, ld, first, cols, nonzero, work());
  }
  bool refines_panels() const override { return schedule_; }
  void solve_panel_refined(const KktMatrix& K, double* X, int ld, int first, int cols, char* nonzero) override {
    sparse::panel_kernels().solve_refined(*schedule_, pattern_->K, K.values.data(), L_.data(), D_.data(),
                                          pattern_->perm.data(), X, ld, first, cols, nonzero, work());
  }
  double panel_error(const KktMatrix& K) override {
    double *of_factor = work(), *of_K = of_factor + D_.size();
    sparse::ldl_row_sums(pattern_->K, K.values.data(), pattern_->ldl, L_.data(), D_.data(), of_factor, of_K);
    return sparse::ldl_rounding(pattern_->ldl) * *std::max_element(of_factor, of_K) /
           *std::max_element(of_K, of_K + D_.size());
  }

  double growth() const override { return growth_; }
  int rank() const override { return pattern_->nc; }
  int nonzeros() const override { return pattern_->ldl.nonzeros() + pattern_->size(); }

 private:
  // For refinement too: a later state may need it, and must not allocate.
  double* work() const {
    return internal::panel_memory(schedule_ ? sparse::panel_kernels().work_size(*schedule_) : 2 * D_.size());
  }
  void take(const std::shared_ptr<const KktPattern>& pattern) {
    pattern_ = nullptr;  // should memory run out
    const sparse::LdlSchedule* schedule = method_ == Method::kSparseLdl ? &pattern->schedule() : nullptr;
    L_.resize(pattern->ldl.nonzeros());
    D_.resize(pattern->size());
    schedule_ = schedule && schedule->compiled ? schedule : nullptr;
    pattern_ = pattern;
  }

  Method method_;
  std::shared_ptr<const KktPattern> pattern_;
  const sparse::LdlSchedule* schedule_ = nullptr;  // the pattern's; nullptr: by SuiteSparse
  std::vector<double> L_, D_;
  double growth_ = 1;
};

}  // namespace

std::unique_ptr<Factor> make_ldl_factor(Method method) { return std::make_unique<LdlFactor>(method); }

}  // namespace manycontact
