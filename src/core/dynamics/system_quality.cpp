#include <algorithm>
#include <cmath>

#include "internal.hpp"
#include "manycontact/sparse/largest.hpp"

namespace manycontact {

namespace {

// Returns the current solution x = [a; y] of K x = b in elimination order, where y = -S^-1 f and S are the row weights.
std::vector<double> given_solution(const Scene& scene, const SceneData& data, const MatrixSystem& m) {
  const Island& island = m.owner.island;
  const int* iperm = m.K.pattern->iperm.data();
  std::vector<double> x(island.size());
  internal::gather(scene, data.f_offset, *m.K.pattern, island, data.a, data.f, x.data());
  for (int row = 0; row < island.nc; ++row) x[iperm[island.nv + row]] /= -unit_of(m, row);
  return x;
}

// Returns D such that the largest entry of each row of D K D is about 1.
std::vector<double> equilibration(const sparse::UpperCsc& A, const std::vector<double>& values) {
  constexpr int kSweeps = 5;  // each sweep halves the logarithms of the row maxima
  std::vector<double> D(A.n, 1.0), rows(A.n);
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    std::ranges::fill(rows, 0.0);
    for (int k = 0; k < A.n; ++k)
      for (int p = A.p[k]; p < A.p[k + 1]; ++p) {
        const double entry = D[k] * std::abs(values[p]) * D[A.i[p]];
        rows[k] = std::max(rows[k], entry);
        rows[A.i[p]] = std::max(rows[A.i[p]], entry);
      }
    for (int k = 0; k < A.n; ++k)
      if (rows[k] > 0) D[k] /= std::sqrt(rows[k]);
  }
  return D;
}

double scaled_condition(MatrixSystem& m) {
  const sparse::UpperCsc& A = m.K.pattern->K;
  const std::vector<double> D = equilibration(A, m.K.values);
  std::vector<double> scaled(m.K.values), sums(A.n);
  for (int k = 0; k < A.n; ++k)
    for (int p = A.p[k]; p < A.p[k + 1]; ++p) scaled[p] *= D[k] * D[A.i[p]];
  const auto unscale = [&D](double* x) {
    for (std::size_t k = 0; k < D.size(); ++k) x[k] /= D[k];
  };
  return sparse::norm_1(A, scaled.data(), sums.data()) *
         internal::inverse_norm(A.n, [&](double* x) { unscale(x), internal::solve_refined_once(m, x), unscale(x); });
}

SystemQuality quality_of(const Scene& scene, const SceneData& data, MatrixSystem& m) {
  const int n = m.owner.island.size();
  const std::vector<double> x = given_solution(scene, data, m);
  std::vector<double> r(n), scale(n);
  sparse::residual(m.K.pattern->K, m.K.values.data(), x.data(), m.v.b.data(), r.data(), scale.data());
  if (m.deficient()) m.factor->project_out(r.data(), nullptr);  // no x can reduce this component of r
  const double norm = internal::norm_of(m);
  using sparse::largest;
  SystemQuality out;
  out.componentwise_backward_error = sparse::componentwise_backward_error(r, scale);
  out.normwise_backward_error = largest(r) == 0 ? 0 : largest(r) / (norm * largest(x) + largest(m.v.b));
  out.growth = m.factor->growth();
  out.condition = internal::condition_of(m);
  out.scaled_condition = scaled_condition(m);
  out.positive = m.owner.island.nv;
  out.negative = m.factor->rank();
  out.zero = m.owner.island.nc - out.negative;
  return out;
}

}  // namespace

std::vector<SystemQuality> system_quality(const Scene& scene, SceneData& data) {
  internal::check_solved(scene, data, "system_quality");
  Workspace& w = *data.workspace;
  if (w.reduction) return system_quality(w.reduction->scene, *w.reduction->data);
  std::vector<SystemQuality> out;
  for (const auto& island : w.islands) {
    MatrixSystem& m = island->matrix;
    if (island->answered && m.make_current(scene, data, w.threads.front()))
      out.push_back(quality_of(scene, data, m));
    else
      out.push_back({kNotEstimated, kNotEstimated, kNotEstimated, kNotEstimated, kNotEstimated});
  }
  return out;
}

}  // namespace manycontact
