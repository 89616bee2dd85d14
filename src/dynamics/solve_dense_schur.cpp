#include <cmath>
#include <limits>

#include "internal.hpp"

namespace manycontact::internal {

namespace {

// The whole scene's M and J.
void gather(const Scene& scene, const SceneData& data, DenseSchurData& d) {
  d.M.setZero(scene.nv, scene.nv);
  d.J.setZero(data.f.size(), scene.nv);
  for (int r = 0; r < scene.nrobots(); ++r) {
    const Model& model = *scene.robots[r].model;
    const int o = scene.robots[r].idx_v;
    unpack_inertia<double>(model, data.robots[r].M.data(), d.M.block(o, o, model.nv, model.nv));
  }
  for (std::size_t c = 0; c < scene.contacts.size(); ++c) {
    if (data.f_offset[c] < 0) continue;
    const Contact& contact = scene.contacts[c];
    const Eigen::MatrixXd& J = data.contacts[c].J;
    int k = 0;
    for (int i : data.supports[c].a)
      d.J.col(scene.robots[contact.A.robot].idx_v + i).segment(data.f_offset[c], J.rows()) = J.col(k++);
    for (int i : data.supports[c].b)
      d.J.col(scene.robots[contact.B.robot].idx_v + i).segment(data.f_offset[c], J.rows()) = J.col(k++);
  }
}

// Smallest Cholesky pivot, relative to the diagonal it came from.
double smallest_pivot(const Eigen::LLT<Eigen::MatrixXd>& llt, const Eigen::VectorXd& diagonal) {
  double ratio = 1;
  for (int k = 0; k < diagonal.size(); ++k) {
    const double l = llt.matrixLLT()(k, k);
    ratio = std::min(ratio, l * l / diagonal[k]);
  }
  return ratio;
}

Reason factor(double delta, DenseSchurData& d) {
  if (!d.M.allFinite() || !d.J.allFinite()) return Reason::kNotFinite;
  d.llt_M.compute(d.M);
  if (d.llt_M.info() != Eigen::Success) return Reason::kSingularInertia;
  if (smallest_pivot(d.llt_M, d.M.diagonal()) < 16 * std::numeric_limits<double>::epsilon())
    return Reason::kSingularInertia;
  d.Z = d.J.transpose();
  if (d.Z.cols() == 0) return Reason::kNone;
  d.llt_M.matrixL().solveInPlace(d.Z);  // Z = L^-1 J^T
  d.S.setZero(d.J.rows(), d.J.rows());
  d.S.selfadjointView<Eigen::Lower>().rankUpdate(d.Z.transpose());  // S = Z^T Z + delta I
  d.S.diagonal().array() += delta;
  d.llt_S.compute(d.S);
  if (d.llt_S.info() != Eigen::Success) return Reason::kSmallPivot;
  return smallest_pivot(d.llt_S, d.S.diagonal()) < 1e-11 ? Reason::kSmallPivot : Reason::kNone;
}

}  // namespace

void solve_dense_schur(const Scene& scene, SceneData& data) {
  DenseSchurData& d = data.dense_schur;
  gather(scene, data, d);
  Reason reason = factor(scene.damping, d);
  if (reason == Reason::kNone) {
    // S f = -a0 - Z^T w, a = L^-T (w + Z f), with w = L^-1 tau_b
    d.y.resize(scene.nv);
    d.f.resize(data.f.size());
    for (const IslandData& i : data.islands) scatter(scene, data, i, i.system.b.data(), d.y, d.f);
    d.llt_M.matrixL().solveInPlace(d.y);
    if (d.f.size() > 0) {
      d.f.noalias() -= d.Z.transpose() * d.y;
      d.llt_S.solveInPlace(d.f);
      d.y.noalias() += d.Z * d.f;
    }
    d.llt_M.matrixU().solveInPlace(d.y);
    if (!d.y.allFinite() || !d.f.allFinite()) reason = Reason::kNotFinite;
  }
  for (std::size_t i = 0; i < data.islands.size(); ++i) {
    IslandData& island = data.islands[i];
    IslandReport& report = data.report.islands[i];
    const int n = island.island.size();
    report.method = Method::kDenseSchur;
    report.factor_nonzeros = n * (n + 1) / 2;
    report.reason = reason;
    if (reason != Reason::kNone) {
      report.status = Status::kFailed;
      std::fill(island.system.x.begin(), island.system.x.end(), std::numeric_limits<double>::quiet_NaN());
      continue;
    }
    island.factor = Factor::kDenseSchur;
    gather(scene, data, island, d.y, -d.f, island.system.x.data());
    // Nothing is refined here: an answer that does not solve the system is none.
    const bool vanishing = scene.damping == 0 && has_vanishing_row(scene, data, island);
    backward_error(island.system);
    report_residuals(scene, island.system, report);
    if (!vanishing && report.residual_dynamics <= 1e-9 && report.residual_contact <= 1e-9) continue;
    island.factor = Factor::kNone;
    report.status = Status::kFailed;
    report.reason = vanishing ? Reason::kSmallPivot : Reason::kLargeResidual;
  }
}

}  // namespace manycontact::internal
