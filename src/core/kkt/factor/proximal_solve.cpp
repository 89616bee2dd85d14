
#include <optional>

#include "manycontact/kkt/factor/refined.hpp"
#include "proximal.hpp"

namespace manycontact::internal {

// Subtracts P y from y, P the projector on J^T's null space, by y -= E^k y, repeated until y stops changing. Adds P y
// to null_component if it is given.
void ProximalFactor::project_out(double* y, double* null_component) { project(y, null_component, kEps); }

void ProximalFactor::project(double* y, double* null_component, double left) {
  if (dropped_.empty()) return;
  double size = 0;
  for (std::size_t k = 0; k < w_.size(); ++k)
    if (!of_M(k)) size = std::max(size, std::abs(y[k]));
  for (int round = 0; round < tolerance::kProjections; ++round) {
    for (std::size_t k = 0; k < w_.size(); ++k) w_[k] = of_M(k) ? 0 : y[k];
    double found = 0;
    for (int k = 0; k < applications_; ++k) {
      apply(w_.data(), 1, 1, nullptr);
      found = sparse::largest(w_);
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

// Copy columns first ... first+cols-1 between the panel X and X_: take_columns to X_, give_columns back.
void ProximalFactor::take_columns(const double* X, int ld, int first, int cols) {
  const std::size_t size = static_cast<std::size_t>(ldl_.pattern->size()) * kChunk;
  for (std::vector<double>* panel : {&X_, &B_, &W_})
    if (panel->size() < size) panel->resize(size);
  for (std::ptrdiff_t k = 0; k < ldl_.pattern->size(); ++k) std::copy_n(X + k * ld + first, cols, &X_[k * kChunk]);
}
void ProximalFactor::give_columns(double* X, int ld, int first, int cols) const {
  for (std::ptrdiff_t k = 0; k < ldl_.pattern->size(); ++k) std::copy_n(&X_[k * kChunk], cols, X + k * ld + first);
}

// W_ <- E^times X_ in the contact rows, for the first `cols` columns. E: the operator of proximal.hpp's file header.
void ProximalFactor::apply_to_columns(int cols, int times) {
  const KktPattern& p = *ldl_.pattern;
  std::fill_n(W_.begin(), static_cast<std::ptrdiff_t>(p.nv) * kChunk, 0.0);
  for (std::ptrdiff_t k = p.nv; k < p.size(); ++k) std::copy_n(&X_[k * kChunk], cols, &W_[k * kChunk]);
  for (int k = 0; k < times; ++k) apply(W_.data(), kChunk, cols, p.perm.data());
}
// X_ -= W_, in the rows in which vectors of J^T's null space have entries.
void ProximalFactor::take_out_of_columns(int cols) {
  const KktPattern& p = *ldl_.pattern;
  for (std::ptrdiff_t k = p.nv; k < p.size(); ++k)
    for (int c = 0; in_null_space_[p.iperm[k]] && c < cols; ++c) X_[k * kChunk + c] -= W_[k * kChunk + c];
}

// Subtracts from X_ its part in J^T's null space, in passes, until at most the fraction `left` of that part is expected
// to remain. Rounding in E (drift_) makes a pass leave the fraction `each`.
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

// Refines first without removing P b, b's part in J^T's null space. If P b is zero, residuals decrease to rounding
// errors. Otherwise they end at P b, and each step adds P b / delta to forces; the solve is then repeated with b - P b.
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
    if (!(left_of_M(v) <= tolerance::kConverged)) {
      // The removed forces had a J^T f of rounding errors, which now is a residual of M's rows. One more step corrects
      // it. The step's own null-space part is removed until it is small relative to all forces.
      ldl_.solve(v.r.data());
      const double f = largest_of_parts(v.x)[0], step = largest_of_parts(v.r)[0];
      project(v.r.data(), nullptr, tolerance::kProjected * std::max(1.0, f / step));
      for (std::size_t k = 0; k < v.x.size(); ++k) v.x[k] += v.r[k];
      residual(K, v);
    }
    refinement.backward_error = backward_error(v.r, v.scale);
  }
  if (contradicts) put_back_contradiction(*this, K, v);
  return refinement;
}

// Subtracts (J^T)^+ J^T P b from P b: its rounding errors in J's range, which S's least eigenvalue would amplify.
void ProximalFactor::refine_contradiction(KktVectors& v) {
  std::fill(v.x.begin(), v.x.end(), 0.0);
  sparse::residual(ldl_.pattern->K, K_->values.data(), v.null_component.data(), v.x.data(), v.r.data(), v.scale.data());
  ldl_.solve(v.r.data());  // solution of K x = [-J^T P b; 0]
  for (std::size_t k = 0; k < v.r.size(); ++k) {
    if (of_M(k)) continue;
    v.null_component[k] += v.r[k];
    v.b[k] -= v.r[k];
  }
}

bool ProximalFactor::agrees(const KktVectors& v) const {
  double r = 0, f = 0;
  for (std::size_t k = 0; k < v.r.size(); ++k) {
    if (of_M(k)) continue;
    r = sparse::larger_or_nan(r, std::abs(v.r[k]));
    f = std::max(f, std::abs(v.x[k]));
  }
  return r <= tolerance::kProximalAgree * delta_ * f;
}

// Refines while a step halves the largest residual, which is relative to the largest terms before the first step, for
// M's and for J's rows. A componentwise error shows no progress at rest, where J's terms vanish.
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

// Returns the largest residual of a row of M, relative to its terms or, if larger, kLeastLoad of the largest terms.
double ProximalFactor::left_of_M(const KktVectors& v) const {
  const double least = tolerance::kLeastLoad * largest_of_parts(v.scale)[1];
  double left = 0;
  for (std::size_t k = 0; least > 0 && k < v.r.size(); ++k)
    if (of_M(k)) left = sparse::larger_or_nan(left, std::abs(v.r[k]) / std::max(v.scale[k], least));
  return left;
}

// Returns the largest magnitude of x in rows of J, and the largest in rows of M.
std::array<double, 2> ProximalFactor::largest_of_parts(const std::vector<double>& x) const {
  std::array<double, 2> out{};
  for (std::size_t k = 0; k < x.size(); ++k) {
    double& of_part = out[of_M(k) ? 1 : 0];
    of_part = sparse::larger_or_nan(of_part, std::abs(x[k]));
  }
  return out;
}

}  // namespace manycontact::internal
