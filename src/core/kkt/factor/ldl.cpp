#include <algorithm>
#include <cmath>
#include <limits>

#include "ldl_numbers.hpp"
#include "manycontact/kkt/factor/factors.hpp"
#include "manycontact/kkt/factor/refined.hpp"
#include "manycontact/rank/dependent_rows.hpp"
#include "manycontact/sparse/ldl_panel_kernels.hpp"
#include "manycontact/sparse/panel_kernels.hpp"
#include "manycontact/sparse/tolerances.hpp"
#include "pivots.hpp"

namespace manycontact {

namespace {

class LdlFactor final : public Factor {
 public:
  LdlFactor(Method method, bool waits) : method_(method), waits_(waits) {}
  Method method() const override { return method_; }

  Reason factorize(const KktMatrix& K, FactorScratch& scratch) override {
    if (ldl_.pattern != K.pattern) take(K.pattern);
    return waits_ ? factorize_waiting(K, scratch) : factorize_all(K, scratch);
  }

  // Overwrites x with (I - P) K_kept^-1 (I - P) x. P: projector on J^T's null space; K_kept: no dropped rows.
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
    const bool dropped = !dependence_.dropped.empty(), joined = dependence_.waiting.joined > 0;
    if (dropped) rank::project_out_panel(dependence_, perm, X, ld, first, cols, nonzero);
    if (joined) rank::before_solve(dependence_.waiting, perm, X + first, ld, cols);
    ldl_.solve_panel(X, ld, first, cols, nonzero);
    if (joined) rank::after_solve(dependence_.waiting, perm, X + first, ld, cols);
    if (dropped) rank::project_out_panel(dependence_, perm, X, ld, first, cols);
  }
  void solve_panel_refined(const KktMatrix& K, double* X, int ld, int first, int cols, PanelWork& work) override {
    if (!ldl_.schedule || !none_waits()) return Factor::solve_panel_refined(K, X, ld, first, cols, work);
    sparse::panel_kernels().solve_refined(*ldl_.schedule, ldl_.pattern->K, K.values.data(), ldl_.L.data(),
                                          ldl_.D.data(), ldl_.pattern->perm.data(), X, ld, first, cols,
                                          work.nonzero.data(), ldl_.work());
  }
  double panel_error(const KktMatrix& K) override {
    if (!none_waits()) return std::numeric_limits<double>::infinity();
    double *of_factor = ldl_.work(), *of_K = of_factor + ldl_.D.size();
    sparse::ldl_row_sums(ldl_.pattern->K, K.values.data(), ldl_.pattern->ldl, ldl_.L.data(), ldl_.D.data(), of_factor,
                         of_K);
    return sparse::ldl_rounding(ldl_.pattern->ldl) * *std::max_element(of_factor, of_K) /
           *std::max_element(of_K, of_K + ldl_.D.size());
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

  // P's error grows with the squares of coefficients z of dependent rows, and with sums of as many terms as a cluster
  // has entries (rank/dependent_rows.hpp).
  double projector_error() const override {
    const double z = dependence_.largest_projected, sums = dependence_.largest_cluster;
    return tolerance::kBoundRounding * std::numeric_limits<double>::epsilon() * (1 + z * z) * std::sqrt(sums);
  }

  int nonzeros() const override { return ldl_.nonzeros(); }

 private:
  void take(const std::shared_ptr<const KktPattern>& pattern) {
    if (waits_) row_size_.assign(pattern->size(), 0.0);
    ldl_.take(pattern, method_);
  }

  Reason factorize_all(const KktMatrix& K, FactorScratch& scratch) {
    if (!ldl_.factor(K.values.data(), nullptr, 0, scratch)) return Reason::kZeroPivot;
    growth_ = internal::growth_of(K, scratch.scale.data());
    const Reason reason = internal::judge_pivots(K, ldl_.L.data(), ldl_.D.data(), scratch);
    // If the growth is infinite, a small residual of one solve proves nothing for other right-hand sides.
    return reason == Reason::kNone && !std::isfinite(growth_) ? Reason::kSmallPivot : reason;
  }

  // Factorizes K such that rows of J without a sound pivot wait (tolerance::kWaits). A waiting row k depends on other
  // rows if J_k - sum z_j J_j, computed from J, is a rounding error. If that is uncertain, returns kSmallPivot.
  Reason factorize_waiting(const KktMatrix& K, FactorScratch& scratch) {
    const KktPattern& p = *ldl_.pattern;
    for (int k = 0; k < p.nc; ++k) row_size_[p.iperm[p.nv + k]] = internal::size_of_row(K, scratch, k);
    const int most = p.nc <= tolerance::kFewRows ? p.nc : tolerance::kMostWaiting;
    rank::least_pivots(p.K, K.values.data(), p.of_M, tolerance::kWaits, row_size_.data(), dependence_.least);
    (void)ldl_.factor(K.values.data(), dependence_.least.data(), most, scratch);
    const int done =
        rank::take_waiting_rows(p.K, K.values.data(), p.of_M, most, scratch.scale.data(), ldl_.D.data(), dependence_);
    if (done < p.size())
      return p.of_M[done]                             ? Reason::kSingularInertia
             : std::ssize(dependence_.dropped) < most ? Reason::kWrongInertia
                                                      : Reason::kSmallPivot;
    growth_ = std::max(1.0, internal::growth_of(K, scratch.scale.data()));
    // Allocates memory for refinement now: later states may need it when nothing may be allocated.
    if (!dependence_.dropped.empty()) (void)ldl_.work();
    const bool found = rank::find_dependence(p.K, p.ldl, K.values.data(), p.of_M, row_size_.data(), ldl_.L.data(),
                                             ldl_.D.data(), solve_, dependence_);
    return found && std::isfinite(growth_) ? Reason::kNone : Reason::kSmallPivot;
  }

  bool none_waits() const { return dependence_.dropped.empty() && dependence_.waiting.joined == 0; }
  void solve_kept(double* x) { rank::solve_kept(dependence_, x, 1, 1, solve_); }

  Method method_;
  bool waits_;
  internal::LdlNumbers ldl_;
  rank::SolvePanel solve_ = [this](double* X, int ld, int cols) { ldl_.solve_in_order(X, ld, cols); };
  std::vector<double> row_size_;  // sizes of J's rows, in K's order; unused for M's rows
  rank::DependentRows dependence_;
  double growth_ = 1;
};

}  // namespace

std::unique_ptr<Factor> make_ldl_factor(Method method) { return std::make_unique<LdlFactor>(method, false); }

std::unique_ptr<Factor> make_waiting_ldl_factor() { return std::make_unique<LdlFactor>(Method::kSparseLdl, true); }

}  // namespace manycontact
