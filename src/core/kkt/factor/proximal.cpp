#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>

#include "ldl_numbers.hpp"
#include "manycontact/kkt/factor/factors.hpp"
#include "manycontact/kkt/factor/refined.hpp"
#include "manycontact/sparse/largest.hpp"
#include "manycontact/sparse/panel_kernels.hpp"
#include "manycontact/sparse/tolerances.hpp"
#include "pivots.hpp"

// Let S = J M^-1 J^T. For a small delta, K_delta = [M J^T; J -delta I] has a factor in any sound order, whichever rows
// of J depend on each other. The operator K_delta^-1 gives three things:
//
//   E y = delta (S + delta)^-1 y          from K_delta [.; x] = [0; y] with x = -E y / delta. On the null space of J^T
//                                         it is the identity, on an eigenvector of S with eigenvalue s it is
//                                         delta / (delta + s). Its powers converge to the projector P.
//   x + K_delta^-1 (b - K x)              a proximal step: from x = 0 it converges to the solution of K x = b
//                                         without P b, whose forces have no part in the null space: those of least
//                                         norm.
//   rank                                  a row that depends on the rows before it has a pivot of delta (1 + |z|^2), z
//                                         its coefficients: a larger delta enlarges it as many times. The pivot of any
//                                         other row hardly depends on delta.
//
// The residual's own rounding, eps of b, becomes forces eps / delta large in the null space (relative to S of 1), which
// moves nothing: P f is taken out at the end. E keeps a vector of the null space but for a part of eps / delta
// ("drift"), so that P is applied several times. Source: Rockafellar, SIAM J. Control Optim. 14 (1976), sec. 4; Gill,
// Saunders, Shinnerl, SIAM J. Matrix Anal. Appl. 17 (1996).

namespace manycontact {

namespace {

constexpr double kEps = std::numeric_limits<double>::epsilon();
constexpr int kProbes = sparse::kTrailingColumns;  // so many vectors take the time of a few
constexpr int kChunk = 64;                         // columns of a panel at a time

using sparse::largest;

class ProximalFactor final : public Factor {
 public:
  Method method() const override { return Method::kSparseLdl; }

  Reason factorize(const KktMatrix& K, FactorScratch& scratch) override {
    if (ldl_.pattern != K.pattern) take(K.pattern);
    K_ = &K;
    delta_ = tolerance::kProximal * largest_of_S();
    if (in_doubt_) find_stiffer_pivots(scratch);
    factorize_damped(delta_, scratch);
    if (const Reason reason = judge(scratch.scale.data()); reason != Reason::kNone) return reason;
    return find_dependent_rows(scratch) && certify(scratch) ? Reason::kNone : Reason::kSmallPivot;
  }

  // The generalised inverse, refined.
  void solve(double* x) override {
    std::copy_n(x, b_.size(), b_.data());
    project_out(b_.data(), nullptr);
    std::copy(b_.begin(), b_.end(), x);
    ldl_.solve(x);
    for (int step = 0; step < own_refinements(); ++step) {
      sparse::panel_kernels().residual_vector(ldl_.pattern->K, K_->values.data(), x, b_.data(), r_.data(),
                                              scale_.data());
      ldl_.solve(r_.data());
      for (std::size_t k = 0; k < r_.size(); ++k) x[k] += r_[k];
    }
    project_out(x, nullptr);
  }
  sparse::Refinement solve_refined(const KktMatrix& K, KktVectors& v, int max_steps) override;
  void solve_panel(double* X, int ld, int first, int cols, char* nonzero) override;

  int own_refinements() const override { return 2; }  // of solve and solve_panel; solve_refined has proximal steps
  double growth() const override { return growth_; }
  int rank() const override { return ldl_.pattern->nc - static_cast<int>(dropped_.size()); }
  void dependent_rows(std::vector<int>& rows) const override { rows.assign(dropped_.begin(), dropped_.end()); }
  int nonzeros() const override { return ldl_.nonzeros(); }
  double left_of_dropped_rows() const override { return left_; }
  void null_space_rows(std::span<char> rows) const override {
    for (int k = 0; k < ldl_.pattern->nc; ++k) rows[k] = in_null_space_[ldl_.pattern->iperm[ldl_.pattern->nv + k]];
  }
  double projector_error() const override {
    return dropped_.empty() ? 0 : std::max(left_, tolerance::kBoundRounding * kEps * std::sqrt(ldl_.pattern->nc));
  }
  void project_out(double* y, double* null_component) override;
  void project_out_panel(double* X, int ld, int cols) override;
  void release_panels() override {
    for (std::vector<double>* panel : {&X_, &B_, &W_}) *panel = {};
  }

 private:
  void take(const std::shared_ptr<const KktPattern>& pattern) {
    const std::size_t n = pattern->size();
    damped_.resize(pattern->K.nonzeros());
    of_M_.resize(n);
    for (std::size_t k = 0; k < n; ++k) of_M_[k] = pattern->perm[k] < pattern->nv;
    M_first_ = std::is_sorted(of_M_.begin(), of_M_.end(), std::greater<>());
    in_null_space_.assign(n, 0);
    dropped_.reserve(pattern->nc);
    stiffer_.resize(n);
    order_.reserve(pattern->nc);
    in_doubt_ = false;
    for (std::vector<double>* x : {&b_, &r_, &scale_, &w_}) x->resize(n);
    for (std::vector<double>* X : {&probes_, &before_}) X->resize(n * kProbes);
    nonzero_.assign(n, 1);
    same_.resize(n);
    std::iota(same_.begin(), same_.end(), 0);
    ldl_.take(pattern, true);
  }

  // The largest diagonal entry of S, M's own diagonal in the place of M.
  double largest_of_S() {
    const sparse::UpperCsc& A = ldl_.pattern->K;
    std::fill(r_.begin(), r_.end(), 0.0);
    for (int k = 0; k < A.n; ++k)
      for (int p = A.p[k]; p < A.p[k + 1] - 1; ++p) {
        const int i = A.i[p];
        if (of_M_[i] == of_M_[k]) continue;
        const int row = of_M_[i] ? k : i, column = of_M_[i] ? i : k;
        r_[row] += K_->values[p] * K_->values[p] / K_->values[A.p[column + 1] - 1];
      }
    return largest(r_);
  }

  // A pivot that is zero, or no number, stays in D.
  void factorize_damped(double delta, FactorScratch& scratch) {
    std::copy(K_->values.begin(), K_->values.end(), damped_.begin());
    for (int slot : ldl_.pattern->diagonal_slot) damped_[slot] = -delta;
    (void)ldl_.factor(damped_.data(), scratch);
  }

  // M's pivots as of any factor; those of J's rows have their sign.
  Reason judge(const double* scale) {
    growth_ = std::max(1.0, internal::growth_of(*K_, scale));
    const sparse::UpperCsc& A = ldl_.pattern->K;
    for (int k = 0; k < A.n; ++k) {
      const double d = ldl_.D[k];
      if (!std::isfinite(d) || d == 0) return Reason::kZeroPivot;
      if ((d > 0) != static_cast<bool>(of_M_[k])) return of_M_[k] ? Reason::kSingularInertia : Reason::kWrongInertia;
      if (of_M_[k] && !rank::is_left<double>({true, d, scale[k], K_->values[A.p[k + 1] - 1]}))
        return Reason::kSingularInertia;
    }
    return growth_ <= tolerance::kMostGrowth ? Reason::kNone : Reason::kSmallPivot;
  }

  // Pivots with a larger delta, for the next functions. The current factor is lost.
  void find_stiffer_pivots(FactorScratch& scratch) {
    factorize_damped(tolerance::kStiffer * delta_, scratch);
    stiffer_ = ldl_.D;
  }

  // Judges rows by their pivots relative to delta, or where one is of a size that both kinds of rows may have,
  // by how pivots change with delta. The result does not depend on in_doubt_, which saves a factorization. False: the
  // rank is in doubt.
  bool find_dependent_rows(FactorScratch& scratch) {
    const KktPattern& p = *ldl_.pattern;
    const bool known = std::exchange(in_doubt_, false);
    dropped_.clear();
    for (int k = 0; k < p.nc; ++k) {
      const double pivot = -ldl_.D[p.iperm[p.nv + k]];
      if (pivot <= tolerance::kPivotOfDependent * delta_)
        dropped_.push_back(k);
      else if (pivot < tolerance::kPivotOfOthers * delta_)
        in_doubt_ = true;
    }
    if (!in_doubt_) return true;
    if (!known) {
      find_stiffer_pivots(scratch);
      factorize_damped(delta_, scratch);
    }
    return compare_pivots(scratch.scale.data());
  }

  // The product of all pivots is det M det (S + delta), in which each zero eigenvalue of S is a factor delta: the
  // exponents of delta in the pivots add up to the number of dependent rows. They are 1 or 0, unless rows nearly depend
  // on those before them and later rows on all of these: such exponents lie between, many of them next to 0 or 1, and
  // only the sum of all is an integer. Rounding of pivots must not add up: what it explains counts as 1 or 0.
  bool compare_pivots(const double* terms) {
    const KktPattern& p = *ldl_.pattern;
    double sum = 0;
    dropped_.clear();
    order_.clear();
    for (int k = 0; k < p.size(); ++k) {
      const double grown = std::log(stiffer_[k] / ldl_.D[k]) / std::log(tolerance::kStiffer);
      if (!std::isfinite(grown)) return false;
      const double plain = std::round(grown);
      const double rounding = tolerance::kExponentRounding * kEps * terms[k] / std::abs(ldl_.D[k]);
      sum += std::abs(grown - plain) <= rounding ? plain : grown;
      if (!of_M_[k]) order_.emplace_back(-grown, p.perm[k] - p.nv);
    }
    const double rows = std::round(sum);
    if (std::abs(sum - rows) > tolerance::kExponentsLeft || !(rows >= 0 && rows <= p.nc)) return false;
    std::sort(order_.begin(), order_.end());
    for (int k = 0; k < rows; ++k) dropped_.push_back(order_[k].second);
    std::sort(dropped_.begin(), dropped_.end());
    return true;
  }

  // Y <- E X of panels with all of K's rows, X's rows of M being zero, and so are then Y's.
  void apply_panel(double* X, int ld, int cols) {
    std::fill(nonzero_.begin(), nonzero_.end(), 1);
    ldl_.solve_panel(X, ld, 0, cols, nonzero_.data());
    const int* perm = ldl_.pattern->perm.data();
    for (int k = 0; k < ldl_.pattern->size(); ++k) {
      double* x = X + static_cast<std::ptrdiff_t>(perm[k]) * ld;
      for (int c = 0; c < cols; ++c) x[c] *= of_M_[k] ? 0 : -delta_;
    }
  }

  // w <- E w for the contacts' rows of w, M's are zero before and after. Where M comes first its columns are not
  // needed.
  void apply(double* w) {
    if (M_first_)
      sparse::ldl_solve_trailing(ldl_.pattern->ldl, ldl_.L.data(), ldl_.D.data(), ldl_.pattern->nv, w);
    else
      ldl_.solve(w);
    for (std::size_t k = 0; k < w_.size(); ++k) w[k] *= of_M_[k] ? 0 : -delta_;
  }

  sparse::Refinement refine(const KktMatrix& K, KktVectors& v);
  std::array<double, 2> largest_of_parts(const std::vector<double>& x) const;
  bool agrees(const KktVectors& v) const;
  void refine_contradiction(KktVectors& v);
  void project(double* y, double* null_component, double left);
  bool certify(FactorScratch& scratch);
  void start_probes();
  void apply_to_probes();
  double* probe(int k) { return probes_.data() + static_cast<std::ptrdiff_t>(k) * kProbes; }
  double left_of_probes(const FactorScratch& scratch);
  void measure_drift();
  void take_null_space_rows();

  void take_columns(const double* X, int ld, int first, int cols);
  void give_columns(double* X, int ld, int first, int cols) const;
  void apply_to_columns(int cols, int times);
  void take_out_of_columns(int cols);
  void project_columns(int cols, double left);
  void solve_columns(int cols);

  internal::LdlNumbers ldl_;
  const KktMatrix* K_ = nullptr;
  double delta_ = 0;
  std::vector<char> of_M_, in_null_space_;     // flags, in K's order
  bool M_first_ = true;                        // no row of M comes after one of J
  std::vector<int> dropped_;                   // rows of J
  std::vector<double> damped_;                 // K_delta
  std::vector<double> stiffer_;                // pivots with a larger delta, in K's order
  std::vector<std::pair<double, int>> order_;  // rows of J that may depend, the surest first
  bool in_doubt_ = false;                      // whether these were needed at the last state
  double growth_ = 1;
  double drift_ = 0;                                         // rounding error of a vector that E keeps
  int applications_ = 1;                                     // how often E is applied, until it is P
  double left_ = 0;                                          // size of J^T on the null space, relative to the rows
  std::vector<double> b_, r_, scale_, w_, probes_, before_;  // scratch, in K's order
  std::vector<double> X_, B_, W_;                            // scratch of panels: kChunk columns of all rows
  std::vector<char> nonzero_;
  std::vector<int> same_;  // 0, 1, 2 ...
};

// Random vectors in the place of P's columns: E^k of them is P of them once J^T of that is rounding, which it never is
// where a row that was dropped depends on the others but nearly: an eigenvector of S that E neither takes away nor
// keeps shows in nearly all random vectors. A row dropped by its pivot alone may have one of kPivotOfDependent delta,
// that E takes away by as much each time. Forces are smoother than these, and have more of the smallest eigenvalues':
// they take one application more.
bool ProximalFactor::certify(FactorScratch& scratch) {
  left_ = drift_ = 0;
  applications_ = 1;
  std::fill(in_null_space_.begin(), in_null_space_.end(), 0);
  if (dropped_.empty()) return true;
  start_probes();
  const double slowest = in_doubt_ ? tolerance::kSlowest : 0.5 / tolerance::kPivotOfDependent;
  double last = std::numeric_limits<double>::infinity();
  for (int k = 1; k < tolerance::kMostApplications; ++k, last = left_) {
    before_ = probes_;
    apply_to_probes();
    measure_drift();
    left_ = left_of_probes(scratch);
    const bool vanishes = left_ <= std::max(tolerance::kRowLeft, tolerance::kGrown * kEps * growth_);
    if (!vanishes && left_ < slowest * last) continue;
    left_ = std::min(left_, last);  // a stalled rest is rounding error: an eigenvector that E keeps leaves more
    if (!vanishes && !(left_ <= tolerance::kMostLeft)) return false;
    applications_ = vanishes ? k + 1 : k;
    take_null_space_rows();
    return true;
  }
  return false;
}

void ProximalFactor::start_probes() {
  const KktPattern& p = *ldl_.pattern;
  std::uint32_t random = 1;
  for (int row = 0; row < p.size(); ++row)
    for (int c = 0; c < kProbes; ++c) {
      random = random * 1664525u + 1013904223u;
      probe(p.iperm[row])[c] = row < p.nv ? 0 : random >> 31 ? 1 : -1;
    }
}

// probes <- E probes
void ProximalFactor::apply_to_probes() {
  const KktPattern& p = *ldl_.pattern;
  if (M_first_) {
    sparse::ldl_solve_trailing_columns(p.ldl, ldl_.L.data(), ldl_.D.data(), p.nv, probes_.data());
  } else {
    std::fill(nonzero_.begin(), nonzero_.end(), 1);
    sparse::ldl_solve_panel(p.ldl, ldl_.L.data(), ldl_.D.data(), same_.data(), probes_.data(), kProbes, 0, kProbes,
                            nonzero_.data());
  }
  for (int k = 0; k < p.size(); ++k)
    for (int c = 0; c < kProbes; ++c) probe(k)[c] *= of_M_[k] ? 0 : -delta_;
}

// The largest entry of J^T times the probes, relative to the terms that its row adds up, or to the largest term of all
// where that is more. A hub's rows add up those of all its contacts.
double ProximalFactor::left_of_probes(const FactorScratch& scratch) {
  const KktPattern& p = *ldl_.pattern;
  double rows = 0, left = 0;
  for (int k = 0; k < p.size(); ++k)
    if (!of_M_[k])
      rows = std::max(rows, largest({probe(k), kProbes}) * internal::size_of_row(*K_, scratch, p.perm[k] - p.nv));
  std::fill(b_.begin(), b_.end(), 0.0);
  for (int c = 0; c < kProbes; ++c) {
    for (int k = 0; k < p.size(); ++k) w_[k] = probe(k)[c];
    sparse::panel_kernels().residual_vector(p.K, K_->values.data(), w_.data(), b_.data(), r_.data(), scale_.data());
    for (int k = 0; k < p.size(); ++k)
      if (of_M_[k]) left = sparse::larger_or_nan(left, std::abs(r_[k]) / std::max(scale_[k], rows));
  }
  return left;
}

// Rounding errors of vectors that E keeps, relative to them: the change of the probes once they are such vectors.
void ProximalFactor::measure_drift() {
  double change = 0;
  for (std::size_t k = 0; k < probes_.size(); ++k)
    change = sparse::larger_or_nan(change, std::abs(probes_[k] - before_[k]));
  drift_ = change / largest(probes_);
}

void ProximalFactor::take_null_space_rows() {
  for (int k = 0; k < ldl_.pattern->size(); ++k)
    in_null_space_[k] = !of_M_[k] && largest({probe(k), kProbes}) > tolerance::kInNullSpace;
}

// y -= E^k y until that changes nothing more.
void ProximalFactor::project_out(double* y, double* null_component) { project(y, null_component, kEps); }

void ProximalFactor::project(double* y, double* null_component, double left) {
  if (dropped_.empty()) return;
  double size = 0;
  for (std::size_t k = 0; k < w_.size(); ++k)
    if (!of_M_[k]) size = std::max(size, std::abs(y[k]));
  for (int round = 0; round < tolerance::kProjections; ++round) {
    for (std::size_t k = 0; k < w_.size(); ++k) w_[k] = of_M_[k] ? 0 : y[k];
    double found = 0;
    for (int k = 0; k < applications_; ++k) {
      apply(w_.data());
      found = largest(w_);
      if (found <= left * size) break;
    }
    for (std::size_t k = 0; k < w_.size(); ++k) {
      if (!in_null_space_[k]) continue;
      y[k] -= w_[k];
      if (null_component) null_component[k] += w_[k];
    }
    if (found * drift_ <= left * size) break;
  }
}

// The panel's columns first ... first+cols-1 between X and a panel of kChunk.
void ProximalFactor::take_columns(const double* X, int ld, int first, int cols) {
  const std::size_t size = static_cast<std::size_t>(ldl_.pattern->size()) * kChunk;
  for (std::vector<double>* panel : {&X_, &B_, &W_})
    if (panel->size() < size) panel->resize(size);
  for (std::ptrdiff_t k = 0; k < ldl_.pattern->size(); ++k) std::copy_n(X + k * ld + first, cols, &X_[k * kChunk]);
}
void ProximalFactor::give_columns(double* X, int ld, int first, int cols) const {
  for (std::ptrdiff_t k = 0; k < ldl_.pattern->size(); ++k) std::copy_n(&X_[k * kChunk], cols, X + k * ld + first);
}

// W <- E^k of the contacts' rows of X_.
void ProximalFactor::apply_to_columns(int cols, int times) {
  const KktPattern& p = *ldl_.pattern;
  std::fill_n(W_.begin(), static_cast<std::ptrdiff_t>(p.nv) * kChunk, 0.0);
  for (std::ptrdiff_t k = p.nv; k < p.size(); ++k) std::copy_n(&X_[k * kChunk], cols, &W_[k * kChunk]);
  for (int k = 0; k < times; ++k) apply_panel(W_.data(), kChunk, cols);
}
// X_ -= W in the null space's rows.
void ProximalFactor::take_out_of_columns(int cols) {
  const KktPattern& p = *ldl_.pattern;
  for (std::ptrdiff_t k = p.nv; k < p.size(); ++k)
    for (int c = 0; in_null_space_[p.iperm[k]] && c < cols; ++c) X_[k * kChunk + c] -= W_[k * kChunk + c];
}

// Until so much is left of the null space's part, each time what rounding makes of it.
void ProximalFactor::project_columns(int cols, double left) {
  const double each = std::min(0.1, applications_ * drift_);
  for (double part = 1; part > left; part *= each) {
    apply_to_columns(cols, applications_);
    take_out_of_columns(cols);
  }
}

void ProximalFactor::project_out_panel(double* X, int ld, int cols) {
  if (dropped_.empty()) return;
  for (int first = 0; first < cols; first += kChunk) {
    const int n = std::min(kChunk, cols - first);
    take_columns(X, ld, first, n);
    project_columns(n, kEps);
    give_columns(X, ld, first, n);
  }
}

void ProximalFactor::solve_columns(int cols) {
  const KktPattern& p = *ldl_.pattern;
  const std::ptrdiff_t size = static_cast<std::ptrdiff_t>(p.size()) * kChunk;
  if (!dropped_.empty()) project_columns(cols, tolerance::kProjected);
  std::copy_n(X_.begin(), size, B_.begin());
  std::fill(nonzero_.begin(), nonzero_.end(), 1);
  ldl_.solve_panel(X_.data(), kChunk, 0, cols, nonzero_.data());
  for (int step = 0; step < own_refinements(); ++step) {
    std::copy_n(B_.begin(), size, W_.begin());
    sparse::residual_panel(p.K, K_->values.data(), p.perm.data(), X_.data(), W_.data(), kChunk, cols);
    std::fill(nonzero_.begin(), nonzero_.end(), 1);
    ldl_.solve_panel(W_.data(), kChunk, 0, cols, nonzero_.data());
    for (std::ptrdiff_t k = 0; k < size; ++k) X_[k] += W_[k];
  }
  if (!dropped_.empty()) project_columns(cols, kEps);
}

void ProximalFactor::solve_panel(double* X, int ld, int first, int cols, char*) {
  for (int begin = first; begin < first + cols; begin += kChunk) {
    const int n = std::min(kChunk, first + cols - begin);
    take_columns(X, ld, begin, n);
    solve_columns(n);
    give_columns(X, ld, begin, n);
  }
}

// The first attempt keeps P b: if b has no such part, steps end with residuals of rounding errors. If it has one, they
// end with it, and each has increased the forces by P b / delta: then the solve is repeated without P b.
sparse::Refinement ProximalFactor::solve_refined(const KktMatrix& K, KktVectors& v, int) {
  std::fill(v.null_component.begin(), v.null_component.end(), 0.0);
  sparse::Refinement refinement = refine(K, v);
  const bool contradicts = !dropped_.empty() && !agrees(v);
  if (contradicts) {
    project(v.b.data(), v.null_component.data(), kEps);
    refine_contradiction(v);
    refinement = refine(K, v);
  }
  if (!dropped_.empty()) {
    project(v.x.data(), nullptr, tolerance::kProjected);
    residual(K, v);
    refinement.backward_error = backward_error(v.r, v.scale);
  }
  if (contradicts) internal::put_back_contradiction(*this, K, v);
  return refinement;
}

// Rounding of P b is as large in J's range as the least eigenvalue of S allows: P b -= (J^T)^+ J^T P b.
void ProximalFactor::refine_contradiction(KktVectors& v) {
  std::fill(v.x.begin(), v.x.end(), 0.0);
  sparse::residual(ldl_.pattern->K, K_->values.data(), v.null_component.data(), v.x.data(), v.r.data(), v.scale.data());
  ldl_.solve(v.r.data());  // solution of K x = [-J^T P b; 0]
  for (std::size_t k = 0; k < v.r.size(); ++k) {
    if (of_M_[k]) continue;
    v.null_component[k] += v.r[k];
    v.b[k] -= v.r[k];
  }
}

bool ProximalFactor::agrees(const KktVectors& v) const {
  double r = 0, f = 0;
  for (std::size_t k = 0; k < of_M_.size(); ++k) {
    if (of_M_[k]) continue;
    r = sparse::larger_or_nan(r, std::abs(v.r[k]));
    f = std::max(f, std::abs(v.x[k]));
  }
  return r <= tolerance::kProximalAgree * delta_ * f;
}

// While the largest residual of M's rows or of J's, each relative to the terms of the first step, is halved: at rest
// the terms of J's rows vanish with their residuals, and a componentwise error shows no progress.
sparse::Refinement ProximalFactor::refine(const KktMatrix& K, KktVectors& v) {
  std::optional<std::array<double, 2>> terms;
  double error = 0, first = 0;
  const auto left_of_terms = [&]() -> double {
    residual(K, v);
    error = backward_error(v.r, v.scale);
    if (!terms) terms = largest_of_parts(v.scale), first = error;
    if (error <= tolerance::kConverged) return 0;
    const std::array<double, 2> r = largest_of_parts(v.r);
    const auto ratio = [&](int part) { return (*terms)[part] > 0 ? r[part] / (*terms)[part] : 0; };
    return sparse::larger_or_nan(ratio(0), ratio(1));
  };
  v.x = v.b;
  ldl_.solve(v.x.data());
  sparse::Refinement out = sparse::refine(tolerance::kProximalSteps, 0, left_of_terms, [&] {
    ldl_.solve(v.r.data());
    for (std::size_t k = 0; k < v.x.size(); ++k) v.x[k] += v.r[k];
  });
  out.first = first, out.backward_error = error;
  return out;
}

// The largest entries of x, by size, in J's rows and in M's.
std::array<double, 2> ProximalFactor::largest_of_parts(const std::vector<double>& x) const {
  std::array<double, 2> out{};
  for (std::size_t k = 0; k < x.size(); ++k) {
    double& of_part = out[of_M_[k] ? 1 : 0];
    of_part = sparse::larger_or_nan(of_part, std::abs(x[k]));
  }
  return out;
}

}  // namespace

std::unique_ptr<Factor> make_proximal_factor() { return std::make_unique<ProximalFactor>(); }

}  // namespace manycontact
