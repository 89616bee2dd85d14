#pragma once
// Let S = J M^-1 J^T. For a small delta > 0, K_delta = [M J^T; J -delta I] has a factor in any sound elimination order,
// even if rows of J are dependent. The operator K_delta^-1 gives three things:
//
//   E y = delta (S + delta)^-1 y          K_delta [.; x] = [0; y] has x = -E y / delta. On the null space of J^T, E
//                                         is the identity; on an eigenvector of S with eigenvalue s, E is
//                                         delta / (delta + s). Powers of E converge to the projector P.
//   x + K_delta^-1 (b - K x)              a proximal step. From x = 0, steps converge to the solution of K x = b with
//                                         b reduced by P b; its forces have no part in the null space, so they are
//                                         the least-norm forces.
//   rank                                  If a row depends on the rows before it, with coefficients z, its pivot is
//                                         delta (1 + |z|^2), proportional to delta. The pivot of any other row
//                                         hardly depends on delta.
//
// Rounding errors of the residual, eps of b, become forces of size eps / delta in the null space (relative to S of 1),
// which cause no acceleration: P f is removed at the end. E changes a vector of the null space by eps / delta of its
// size ("drift"), so E^k is only an approximate projector and is applied several times. Source: Rockafellar, SIAM J.
// Control Optim. 14 (1976), sec. 4; Gill, Saunders, Shinnerl, SIAM J. Matrix Anal. Appl. 17 (1996).

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "ldl_numbers.hpp"
#include "manycontact/kkt/factor/factors.hpp"
#include "manycontact/sparse/largest.hpp"
#include "manycontact/sparse/panel_kernels.hpp"
#include "manycontact/sparse/tolerances.hpp"
#include "pivots.hpp"

namespace manycontact::internal {

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

  int own_refinements() const override { return 2; }  // steps of solve and solve_panel; solve_refined makes none
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
  static constexpr double kEps = std::numeric_limits<double>::epsilon();
  static constexpr int kProbes = 8;  // random vectors to which E is applied; eight take the time of a few
  static constexpr int kChunk = 64;  // columns of a panel that are solved at a time
  void take(const std::shared_ptr<const KktPattern>& pattern) {
    const std::size_t n = pattern->size();
    damped_.resize(pattern->K.nonzeros());
    in_null_space_.assign(n, 0);
    dropped_.reserve(pattern->nc);
    stiffer_.resize(n);
    order_.reserve(pattern->nc);
    in_doubt_ = false;
    for (std::vector<double>* x : {&b_, &r_, &scale_, &w_}) x->resize(n);
    for (std::vector<double>* X : {&probes_, &before_}) X->resize(n * kProbes);
    sums_.resize(2 * n * kProbes);
    nonzero_.assign(n, 1);
    ldl_.take(pattern, method());
  }

  double largest_of_S() {  // approximated with M's diagonal
    const sparse::UpperCsc& A = ldl_.pattern->K;
    std::fill(r_.begin(), r_.end(), 0.0);
    for (int k = 0; k < A.n; ++k)
      for (int p = A.p[k]; p < A.p[k + 1] - 1; ++p) {
        const int i = A.i[p];
        if (of_M(i) == of_M(k)) continue;
        const int row = of_M(i) ? k : i, column = of_M(i) ? i : k;
        r_[row] += K_->values[p] * K_->values[p] / K_->values[A.p[column + 1] - 1];
      }
    return sparse::largest(r_);
  }

  // Factorizes K_delta. A pivot that is zero or NaN remains in D, for judge to reject.
  void factorize_damped(double delta, FactorScratch& scratch) {
    std::copy(K_->values.begin(), K_->values.end(), damped_.begin());
    for (int slot : ldl_.pattern->diagonal_slot) damped_[slot] = -delta;
    (void)ldl_.factor(damped_.data(), nullptr, 0, scratch);
  }

  // Checks the factor and its growth: pivots of M as in other factors; those of J need only be negative.
  Reason judge(const double* scale) {
    growth_ = std::max(1.0, growth_of(*K_, scale));
    const sparse::UpperCsc& A = ldl_.pattern->K;
    for (int k = 0; k < A.n; ++k) {
      const double d = ldl_.D[k];
      if (!std::isfinite(d) || d == 0) return Reason::kZeroPivot;
      if ((d > 0) != of_M(k)) return of_M(k) ? Reason::kSingularInertia : Reason::kWrongInertia;
      if (of_M(k) && !rank::is_left<double>({true, d, scale[k], K_->values[A.p[k + 1] - 1]}))
        return Reason::kSingularInertia;
    }
    return growth_ <= tolerance::kMostGrowth ? Reason::kNone : Reason::kSmallPivot;
  }

  // Factorizes K with kStiffer times delta and stores the pivots in stiffer_. This overwrites the factor for delta.
  void find_stiffer_pivots(FactorScratch& scratch) {
    factorize_damped(tolerance::kStiffer * delta_, scratch);
    stiffer_ = ldl_.D;
  }

  // Lists dependent rows in dropped_ by the ratios of pivots to delta or, if ambiguous, by their change with delta.
  // False: the rank is in doubt. If in_doubt_ was set at the last state, stiffer_ is known: a factorization is saved.
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

  // Lists dependent rows in dropped_ by the exponents with which pivots grow with delta; false: the rank is in doubt.
  // The product of pivots is det M det (S + delta), with a factor delta for each zero eigenvalue of S, so exponents add
  // up to the number of dependent rows. Usually each is 1 or 0; rows that nearly depend on earlier rows have others.
  // Those within rounding error of 1 or 0 are rounded, so that errors do not add up.
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
      if (!of_M(k)) order_.emplace_back(-grown, p.perm[k] - p.nv);
    }
    const double rows = std::round(sum);
    if (std::abs(sum - rows) > tolerance::kExponentsLeft || !(rows >= 0 && rows <= p.nc)) return false;
    std::sort(order_.begin(), order_.end());
    for (int k = 0; k < rows; ++k) dropped_.push_back(order_[k].second);
    std::sort(dropped_.begin(), dropped_.end());
    return true;
  }

  // X <- E X (file header) for the first `cols` columns of a row-major panel with row stride ld. Row k of K is row
  // row[k] of X, or row k if row is nullptr. The rows of M are zero before and after.
  void apply(double* X, int ld, int cols, const int* row) {
    std::fill(nonzero_.begin(), nonzero_.end(), 1);
    row ? ldl_.solve_panel(X, ld, 0, cols, nonzero_.data()) : ldl_.solve_in_order(X, ld, cols);
    for (std::ptrdiff_t k = 0; k < ldl_.pattern->size(); ++k) {
      double* x = X + (row ? row[k] : k) * ld;
      for (int c = 0; c < cols; ++c) x[c] *= of_M(k) ? 0 : -delta_;
    }
  }

  sparse::Refinement refine(const KktMatrix& K, KktVectors& v);
  double left_of_M(const KktVectors& v) const;
  std::array<double, 2> largest_of_parts(const std::vector<double>& x) const;
  bool agrees(const KktVectors& v) const;
  void refine_contradiction(KktVectors& v);
  void project(double* y, double* null_component, double left);
  bool certify(FactorScratch& scratch);
  void start_probes();
  bool of_M(std::size_t k) const { return ldl_.pattern->of_M[k] != 0; }
  double* probe(int k) { return probes_.data() + static_cast<std::ptrdiff_t>(k) * kProbes; }
  double* terms_of(int k) { return sums_.data() + static_cast<std::ptrdiff_t>(k) * 2 * kProbes; }
  double left_of_probes(const FactorScratch& scratch);
  void measure_drift();
  void take_null_space_rows();

  void take_columns(const double* X, int ld, int first, int cols);
  void give_columns(double* X, int ld, int first, int cols) const;
  void apply_to_columns(int cols, int times);
  void take_out_of_columns(int cols);
  void project_columns(int cols, double left);
  void solve_columns(int cols);

  LdlNumbers ldl_;
  const KktMatrix* K_ = nullptr;
  double delta_ = 0;
  std::vector<char> in_null_space_;            // flags of rows with entries in J^T's null space, in K's order
  std::vector<int> dropped_;                   // dependent rows, numbered as rows of J
  std::vector<double> damped_;                 // values of K_delta
  std::vector<double> stiffer_;                // pivots with delta times kStiffer, in K's order
  std::vector<std::pair<double, int>> order_;  // (-exponent, row of J), the most certainly dependent rows first
  bool in_doubt_ = false;                      // whether find_dependent_rows compared pivots at the last state
  double growth_ = 1;
  double drift_ = 0;                                         // relative rounding error of E y for y in J^T's null space
  int applications_ = 1;                                     // number of applications of E that approximate P
  double left_ = 0;                                          // largest J^T n of projected probes n, relative to terms
  std::vector<double> b_, r_, scale_, w_, probes_, before_;  // scratch, in K's order
  std::vector<double> sums_;                                 // scratch: J^T probes_, and |J|^T |probes_|, in rows of M
  std::vector<double> X_, B_, W_;                            // scratch of panels: kChunk columns of all rows
  std::vector<char> nonzero_;
};

}  // namespace manycontact::internal
