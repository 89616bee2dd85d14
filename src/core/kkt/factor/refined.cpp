#include "manycontact/kkt/factor/refined.hpp"

#include <algorithm>
#include <cmath>

#include "manycontact/sparse/largest.hpp"
#include "manycontact/sparse/tolerances.hpp"

namespace manycontact {

namespace {

// Removes rounding errors from P b, the inconsistent part of b's contact rows, by P b -= (J^T)^+ J^T P b: in rows with
// large entries (rotations, with lengths of micrometres) they hide P b. If this correction exceeds rounding, rows are
// only nearly dependent, and P b is kept. v.x, v.r, v.scale: scratch.
void refine_contradiction(Factor& factor, const KktMatrix& K, KktVectors& v) {
  using sparse::largest;
  const double missed = largest(v.null_component), size = std::max(largest(v.b), missed);
  if (!(missed > tolerance::kDriftRounding * size)) return;
  std::fill(v.x.begin(), v.x.end(), 0.0);
  sparse::residual(K.pattern->K, K.values.data(), v.null_component.data(), v.x.data(), v.r.data(), v.scale.data());
  factor.solve(v.r.data());
  for (int k = 0; k < K.pattern->size(); ++k)
    if (K.pattern->perm[k] < K.pattern->nv) v.r[k] = 0;
  if (!(largest(v.r) <= tolerance::kDriftRounding * size)) return;
  for (std::size_t k = 0; k < v.r.size(); ++k) {
    v.null_component[k] += v.r[k];
    v.b[k] -= v.r[k];
  }
}

void take_out_contradiction(Factor& factor, const KktMatrix& K, KktVectors& v) {
  if (factor.rank() == K.nc()) return;
  std::fill(v.null_component.begin(), v.null_component.end(), 0.0);
  factor.project_out(v.b.data(), v.null_component.data());
  refine_contradiction(factor, K, v);
}

}  // namespace

void internal::put_back_contradiction(const Factor& factor, const KktMatrix& K, KktVectors& v) {
  if (factor.rank() == K.nc()) return;
  for (int k = 0; k < K.size(); ++k) {
    if (v.null_component[k] == 0) continue;
    v.scale[k] -= std::abs(v.b[k]);
    v.b[k] += v.null_component[k];
    v.r[k] += v.null_component[k];
    v.scale[k] += std::abs(v.b[k]);
  }
}

sparse::Refinement Factor::solve_refined(const KktMatrix& K, KktVectors& v, int max_steps) {
  take_out_contradiction(*this, K, v);
  v.x = v.b;
  solve(v.x.data());
  const sparse::Refinement refinement = sparse::refine(
      max_steps, tolerance::kRefined,
      [&] {
        residual(K, v);
        return backward_error(v.r, v.scale);
      },
      [&] {
        correct(v.r.data());
        for (std::size_t k = 0; k < v.x.size(); ++k) v.x[k] += v.r[k];
      });
  internal::put_back_contradiction(*this, K, v);
  return refinement;
}

namespace {

// Returns the largest error |R| / (|K|_1 |X| + |B|) of a panel's columns, R = B - K X. sums: memory for three rows.
double column_error(const KktMatrix& K, int ld, const double* B, const double* X, const double* R,
                    std::vector<double>& sums) {
  sums.resize(std::max<std::size_t>(K.size(), 3 * static_cast<std::size_t>(ld)));
  const double norm = sparse::norm_1(K.pattern->K, K.values.data(), sums.data());
  using Row = Eigen::Map<Eigen::RowVectorXd>;
  using ConstRow = Eigen::Map<const Eigen::RowVectorXd>;
  Row b(sums.data(), ld), x(sums.data() + ld, ld), r(sums.data() + 2 * ld, ld);
  b.setZero(), x.setZero(), r.setZero();
  for (std::ptrdiff_t k = 0; k < K.size(); ++k) {
    b = b.cwiseMax(ConstRow(B + k * ld, ld).cwiseAbs());
    x = x.cwiseMax(ConstRow(X + k * ld, ld).cwiseAbs());
    for (int c = 0; c < ld; ++c) r[c] = sparse::larger_or_nan(r[c], std::abs(R[k * ld + c]));
  }
  double worst = 0;
  for (int c = 0; c < ld; ++c)
    if (!(r[c] <= tolerance::kVanishing)) worst = sparse::larger_or_nan(worst, r[c] / (norm * x[c] + b[c]));
  return worst;
}

}  // namespace

void Factor::solve_panel_refined(const KktMatrix& K, double* X, int ld, int first, int cols, PanelWork& work) {
  constexpr int kChunk = 64;  // number of columns of X and B that fit into the caches together
  const KktPattern& p = *K.pattern;
  double* B = work.B.data();
  for (int c = first; c < first + cols; c += kChunk) {
    const int n = std::min(kChunk, first + cols - c);
    for (std::ptrdiff_t k = 0; k < K.size(); ++k) std::copy_n(X + k * ld + c, n, B + k * ld);
    solve_panel(X, ld, c, n, work.nonzero.data());
    sparse::residual_panel(p.K, K.values.data(), p.perm.data(), X + c, B, ld, n);
    std::fill_n(work.nonzero.begin(), K.size(), 1);  // all rows of a residual may be nonzero
    solve_panel(B, ld, 0, n, work.nonzero.data());
    for (std::ptrdiff_t k = 0; k < K.size(); ++k)
      for (int i = 0; i < n; ++i) X[k * ld + c + i] += B[k * ld + i];
  }
}

double refine_panel(Factor& factor, const KktMatrix& K, double* X, int ld, PanelWork& work) {
  const KktPattern& p = *K.pattern;
  const std::size_t size = static_cast<std::size_t>(K.size()) * ld;
  double* B = work.B.data();
  if (work.R.size() < size) work.R.resize(size);
  const auto residual = [&] {
    std::copy_n(B, size, work.R.data());
    sparse::residual_panel(p.K, K.values.data(), p.perm.data(), X, work.R.data(), ld, ld);
    if (factor.rank() < K.nc()) factor.project_out_panel(work.R.data(), ld, ld);  // the least-squares residual
    return column_error(K, ld, B, X, work.R.data(), work.sums);
  };
  const auto correct = [&] {
    std::fill_n(work.nonzero.begin(), K.size(), 1);
    factor.solve_panel(work.R.data(), ld, 0, ld, work.nonzero.data());
    for (std::size_t at = 0; at < size; ++at) X[at] += work.R[at];
  };
  return sparse::refine(tolerance::kPanelSteps - 1, tolerance::kPanelRefined, residual, correct).backward_error;
}

}  // namespace manycontact
