#include <cmath>
#include <limits>

#include "internal.hpp"

namespace manycontact::internal {

namespace {

// Relative residuals: more than the rounding of the largest scenes; of factors that hold nothing.
constexpr double kResidual = 1e-12, kHopeless = 1e-9;

// The whole scene's M and J.
void form_matrices(const Scene& scene, const SceneData& data, DenseSchurData& d) {
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
  if (smallest_pivot(d.llt_M, d.M.diagonal()) < kSmallestPivotRatio) return Reason::kSingularInertia;
  d.Z = d.J.transpose();
  if (d.Z.cols() == 0) return Reason::kNone;
  d.llt_M.matrixL().solveInPlace(d.Z);  // Z = L^-1 J^T
  d.S.setZero(d.J.rows(), d.J.rows());
  d.S.selfadjointView<Eigen::Lower>().rankUpdate(d.Z.transpose());  // S = Z^T Z + delta I
  d.S.diagonal().array() += delta;
  d.llt_S.compute(d.S);
  if (d.llt_S.info() != Eigen::Success) return Reason::kSmallPivot;
  return smallest_pivot(d.llt_S, d.S.diagonal()) < kSmallestPivotRatio ? Reason::kSmallPivot : Reason::kNone;
}

// [y; f] <- [a; f] with K [a; -f] = [y; f]: S f = f - Z^T w, a = L^-T (w + Z f), with w = L^-1 y.
void apply(DenseSchurData& d) {
  d.llt_M.matrixL().solveInPlace(d.y);
  if (d.f.size() > 0) {
    d.f.noalias() -= d.Z.transpose() * d.y;
    d.llt_S.solveInPlace(d.f);
    d.y.noalias() += d.Z * d.f;
  }
  d.llt_M.matrixU().solveInPlace(d.y);
}

double largest_residual(const Scene& scene, SceneData& data) {
  double largest = 0;
  for (std::size_t i = 0; i < data.islands.size(); ++i) {
    IslandReport& report = data.report.islands[i];
    backward_error(data.islands[i].system);
    report_residuals(scene, data.islands[i].system, report);
    for (double r : {report.residual_dynamics, report.residual_contact})
      if (!(r <= largest)) largest = r;  // NaN too
  }
  return largest;
}

// As Crocoddyl does; then, where that lost digits, two steps of refinement. Returns their number.
int solve_system(const Scene& scene, SceneData& data) {
  DenseSchurData& d = data.dense_schur;
  d.y.resize(scene.nv);
  d.f.resize(data.f.size());
  for (const IslandData& i : data.islands) scatter(scene, data, i, i.system.b.data(), d.y, d.f);
  apply(d);
  for (IslandData& i : data.islands) gather(scene, data, i, d.y, -d.f, i.system.x.data());
  int steps = 0;
  for (double left; steps < 2; ++steps) {
    left = largest_residual(scene, data);
    if (!(left > kResidual && left <= kHopeless)) return steps;
    for (const IslandData& i : data.islands) scatter(scene, data, i, i.system.r.data(), d.y, d.f);
    apply(d);
    for (IslandData& i : data.islands) {
      gather(scene, data, i, d.y, -d.f, i.system.r.data());
      for (std::size_t k = 0; k < i.system.x.size(); ++k) i.system.x[k] += i.system.r[k];
    }
  }
  largest_residual(scene, data);
  return steps;
}

}  // namespace

void solve_dense_schur(const Scene& scene, SceneData& data) {
  DenseSchurData& d = data.dense_schur;
  form_matrices(scene, data, d);
  const Reason reason = factor(scene.damping, d);
  const int steps = reason == Reason::kNone ? solve_system(scene, data) : 0;
  for (std::size_t i = 0; i < data.islands.size(); ++i) {
    IslandData& island = data.islands[i];
    IslandReport& report = data.report.islands[i];
    const int n = island.island.size();
    report.method = Method::kDenseSchur;
    report.factor_nonzeros = n * (n + 1) / 2;
    report.refinement_steps = steps;
    report.reason = reason;
    if (reason == Reason::kNone) {  // an answer that does not solve the system is none
      const bool vanishing = scene.damping == 0 && has_vanishing_row(scene, data, island);
      const bool solved = report.residual_dynamics <= kResidual && report.residual_contact <= kResidual;
      if (solved && !vanishing) {
        island.factor = Factor::kDenseSchur;
        continue;
      }
      report.reason = vanishing                                 ? Reason::kSmallPivot
                      : std::isfinite(report.residual_dynamics) ? Reason::kLargeResidual
                                                                : Reason::kNotFinite;
    }
    report.status = Status::kFailed;
    std::fill(island.system.x.begin(), island.system.x.end(), std::numeric_limits<double>::quiet_NaN());
  }
}

}  // namespace manycontact::internal
