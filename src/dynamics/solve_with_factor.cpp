#include <cmath>

#include "internal.hpp"

namespace manycontact::internal {

namespace {

// [a; y] <- K^-1 [b1; b2] by the Schur complement: with w = D^-1/2 L^-T b1 and Z = D^-1/2 L^-T J^T,
// S y = Z^T w - b2, a = L^-1 D^-1/2 (w - Z y). x is in elimination order.
void solve_supernodal(const Scene& scene, IslandData& d, double* x) {
  const int* iperm = d.system.pattern->iperm.data();
  const Island& island = d.island;
  Eigen::VectorXd& w = d.schur.w;
  Eigen::VectorXd& y = d.schur.y;
  w.resize(island.nv);
  y.resize(island.nc);
  for (int k = 0; k < island.nc; ++k) y[k] = -x[iperm[island.nv + k]];
  const auto each_row = [&](std::size_t r, auto&& use) {  // use(row of y, row of the robot)
    const SchurPattern::OnRobot& on = d.schur_pattern->robots[r];
    for (std::size_t k = 0; k < on.contacts.size(); ++k) {
      const int rows = scene.contacts[island.contacts[on.contacts[k]]].rows();
      for (int i = 0; i < rows; ++i) use(island.row_offset[on.contacts[k]] + i, on.first_row[k] + i);
    }
  };
  for (std::size_t r = 0; r < island.robots.size(); ++r) {
    const Model& model = *scene.robots[island.robots[r]].model;
    auto wr = w.segment(island.dof_offset[r], model.nv);
    const double* L = d.schur.L[r].data();
    for (int i = 0; i < model.nv; ++i) wr[i] = x[iperm[island.dof_offset[r] + i]];
    solve_inertia_transposed(model, L, wr.data());
    for (int i = 0; i < model.nv; ++i) wr[i] /= std::sqrt(L[model.M_begin[i]]);
    each_row(r, [&](int row, int k) { y[row] += d.schur.Z[r].col(k).dot(wr); });
  }
  if (island.nc > 0) d.cholmod->solve(y.data(), 1);
  for (std::size_t r = 0; r < island.robots.size(); ++r) {
    const Model& model = *scene.robots[island.robots[r]].model;
    auto wr = w.segment(island.dof_offset[r], model.nv);
    const double* L = d.schur.L[r].data();
    each_row(r, [&](int row, int k) { wr -= y[row] * d.schur.Z[r].col(k); });
    for (int i = 0; i < model.nv; ++i) wr[i] /= std::sqrt(L[model.M_begin[i]]);
    solve_inertia_unit(model, L, wr.data());
    for (int i = 0; i < model.nv; ++i) x[iperm[island.dof_offset[r] + i]] = wr[i];
  }
  for (int k = 0; k < island.nc; ++k) x[iperm[island.nv + k]] = y[k];
}

void solve_dense(IslandData& d, double* x) {
  const int nv = d.island.nv, nc = d.island.nc;
  const int* iperm = d.system.pattern->iperm.data();
  Eigen::MatrixXd b1(nv, 1), b2(nc, 1), a, f;
  for (int k = 0; k < nv; ++k) b1(k, 0) = x[iperm[k]];
  for (int k = 0; k < nc; ++k) b2(k, 0) = x[iperm[nv + k]];
  solve<double>(*d.dense, b1, b2, a, f);
  for (int k = 0; k < nv; ++k) x[iperm[k]] = a(k, 0);
  for (int k = 0; k < nc; ++k) x[iperm[nv + k]] = -f(k, 0);
}

}  // namespace

void solve_with_factor(const Scene& scene, IslandData& d, double* x) {
  switch (d.factor) {
    case Factor::kLdl:
      return sparse::ldl_solve(d.system.pattern->ldl, d.Lx.data(), d.D.data(), x);
    case Factor::kDependent:
      sparse::project_out(d.rows, x);
      sparse::ldl_solve(d.system.pattern->ldl, d.Lx.data(), d.D.data(), x);
      return sparse::project_out(d.rows, x);
    case Factor::kCholmod:
      return d.cholmod->solve(x, 1);
    case Factor::kSupernodal:
      return solve_supernodal(scene, d, x);
    case Factor::kDense:
      return solve_dense(d, x);
    case Factor::kDenseSchur:
    case Factor::kNone:
      std::fill(x, x + d.island.size(), std::numeric_limits<double>::quiet_NaN());
  }
}

}  // namespace manycontact::internal
