#include <cmath>

#include "internal.hpp"

namespace manycontact::internal {

namespace {

// The island's M and J as dense matrices.
void gather(const Scene& scene, const IslandData& d, DenseKkt<double>& kkt) {
  const Island& island = d.island;
  kkt.M.setZero(island.nv, island.nv);
  kkt.J.setZero(island.nc, island.nv);
  kkt.delta = scene.damping;
  for (std::size_t r = 0; r < island.robots.size(); ++r) {
    const Model& model = *scene.robots[island.robots[r]].model;
    const int o = island.dof_offset[r];
    unpack_inertia<double>(model, d.M[r].data(), kkt.M.block(o, o, model.nv, model.nv));
  }
  for (std::size_t c = 0; c < island.contacts.size(); ++c) {
    const int rows = scene.contacts[island.contacts[c]].rows();
    const double* J = d.J[c].data();
    for (int column : d.support.columns[c])
      for (int i = 0; i < rows; ++i) kkt.J(island.row_offset[c] + i, column) = *J++;
  }
}

bool contradictory(double size, const DenseKkt<double>& kkt, const Eigen::MatrixXd& a,
                   const Eigen::MatrixXd& minus_a0) {
  return internal::contradictory((kkt.J * a - minus_a0).cwiseAbs().maxCoeff(),
                                 (kkt.J.cwiseAbs() * a.cwiseAbs()).maxCoeff(), minus_a0.cwiseAbs().maxCoeff(), size);
}

}  // namespace

void solve_dense(const Scene& scene, const SceneData& data, IslandData& d, IslandReport& report) {
  const int nv = d.island.nv, nc = d.island.nc;
  if (!d.dense) d.dense = std::make_unique<DenseKkt<double>>();
  DenseKkt<double>& kkt = *d.dense;
  gather(scene, d, kkt);
  kkt.J_size = motion_size(scene, data, d.island);
  factor<double>(kkt);
  report.method = Method::kDense;
  report.rank = kkt.delta > 0 ? nc : kkt.rank;
  report.factor_nonzeros = (nv + nc) * (nv + nc + 1) / 2;
  report.refinement_steps = 1;
  KktSystem& s = d.system;
  const int* iperm = s.pattern->iperm.data();
  Eigen::MatrixXd b1(nv, 1), b2(nc, 1), a, f;
  for (int k = 0; k < nv; ++k) b1(k, 0) = s.b[iperm[k]];
  for (int k = 0; k < nc; ++k) b2(k, 0) = s.b[iperm[nv + k]];
  solve<double>(kkt, b1, b2, a, f);
  for (int k = 0; k < nv; ++k) s.x[iperm[k]] = a(k, 0);
  for (int k = 0; k < nc; ++k) s.x[iperm[nv + k]] = -f(k, 0);
  backward_error(s);
  if (!kkt.regular || !a.allFinite() || !f.allFinite()) {
    report.status = Status::kFailed;
    const bool finite = kkt.M.allFinite() && kkt.J.allFinite() && b1.allFinite() && b2.allFinite();
    report.reason = !finite ? Reason::kNotFinite : kkt.holds ? Reason::kSmallPivot : Reason::kSingularInertia;
    return;
  }
  d.factor = Factor::kDense;
  if (kkt.rank == nc || kkt.delta > 0) return;
  const auto& order = kkt.cod.colsPermutation().indices();
  name_dependent_rows(data, d.island, order.tail(nc - kkt.rank), report);
  report.status =
      contradictory(drift_size(scene, data, d.island), kkt, a, b2) ? Status::kInconsistent : Status::kRedundant;
}

}  // namespace manycontact::internal
