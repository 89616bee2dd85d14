#include <algorithm>
#include <cmath>

#include "../../internal.hpp"
#include "manycontact/sparse/tolerances.hpp"
#include "matrix.hpp"

// With dependent rows the force of least norm stays in J's range: P f = 0 for the projector P = I - J J^+ on J^T's null
// space. Differentiated at constant rank, P df = P dJ y with y = J^+ f; dJ y is the derivative of J(q) y at constant y,
// that is, of the contacts' velocities when the joints move with y.

namespace manycontact::internal {

namespace {

using V6 = Vec6<double>;

// w.y with J y = w.f, f in J's range. (Which one does not matter: d(J n) = 0 along J n = 0.) Refined on K, as every
// solve is, unless the oracle has decomposed J itself.
void any_motion(const MatrixSystem& m, DependentDerivatives& w) {
  const int* iperm = m.K.pattern->iperm.data();
  thread_local KktVectors v;  // memory
  v.resize(m.owner.island.size());
  std::fill(v.b.begin(), v.b.end(), 0.0);
  for (int k = 0; k < m.owner.island.nc; ++k) v.b[iperm[m.owner.island.nv + k]] = w.f[k];
  if (m.factor->own_refinements() > 0) {
    v.x = v.b;
    m.factor->particular_solution(v.x.data());
  } else {
    solve_refined(*m.factor, m.K, v, tolerance::kRefinementSteps);
  }
  w.y.resize(m.owner.island.nv);
  for (int k = 0; k < m.owner.island.nv; ++k) w.y[k] = v.x[iperm[k]];
}

// w.D = d(J(q) y)/dq, nc x nv.
void jacobian_rate(const Scene& scene, const Workspace& work, const IslandWork& d, DependentDerivatives& w) {
  const Island& island = d.island;
  const Linearisation& lin = *work.linearisation;
  for (std::size_t k = 0; k < island.robots.size(); ++k) {
    const Robot& robot = scene.robots[island.robots[k]];
    if (w.kin.size() == k) w.kin.emplace_back(*robot.model);
    w.kin[k] = work.robots[island.robots[k]].kin;
    forward_accelerations<double>(*robot.model, w.y.segment(island.dof_offset[k], robot.model->nv), nullptr,
                                  scene.gravity, w.kin[k]);
  }
  w.D.setZero(island.nc, island.nv);
  for (std::size_t c = 0; c < island.contacts.size(); ++c) {
    const Contact& contact = scene.contacts[island.contacts[c]];
    const ContactSupport& support = work.supports[island.contacts[c]];
    const ContactData<double>& rows = lin.contacts[island.contacts[c]];
    const ContactDerivatives& terms = lin.derivatives[island.contacts[c]];
    const int a = moves(contact.A) ? local_robot(island, contact.A.robot) : -1,
              b = moves(contact.B) ? local_robot(island, contact.B.robot) : -1;
    V6 vB = V6::Zero(), nu = V6::Zero();
    if (b >= 0) vB = rows.bMA.act_inverse(w.kin[b].v[contact.B.joint]);
    int k = 0;
    const auto column = [&](int robot, int i, const SE3<double>& M, double sign) {
      const Model& model = *scene.robots[island.robots[robot]].model;
      const int parent = model.joints[model.dof_joint[i]].parent;
      const V6 s = rows.Jl.col(k);
      V6 dnu = cross_motion(s, vB);
      if (parent >= 0) dnu += sign * M.act_inverse(cross_motion(w.kin[robot].v[parent], w.kin[robot].J.col(i)));
      const int col = d.shape->support().columns[c][k];
      w.D.block(island.row_offset[c], col, contact.rows(), 1).noalias() += rows.W * dnu;
      nu += s * w.y[col];
      ++k;
    };
    for (int i : support.a) column(a, i, rows.aMA, 1);
    for (int i : support.b) column(b, i, rows.bMA, -1);
    if (!terms.turns) continue;
    for (std::size_t i = 0; i < terms.chain_a.size(); ++i) {
      const V6 dnu = turned<double>(terms.turn.col(i), nu);
      w.D.block(island.row_offset[c], island.dof_offset[a] + terms.chain_a[i], contact.rows(), 1).noalias() +=
          rows.W * dnu;
    }
  }
}

// The island's part of the scene's forces.
void take_forces(const Scene& scene, const SceneData& data, const Island& island, Eigen::VectorXd& f) {
  f.resize(island.nc);
  each_force_block(scene, data.f_offset, island,
                   [&](int from, int to, int n) { f.segment(to, n) = data.f.segment(from, n); });
}

}  // namespace

void least_norm_forces(const Scene& scene, SceneData& data, MatrixSystem& m, IslandDerivatives& out) {
  DependentDerivatives& w = *m.rows;
  take_forces(scene, data, m.owner.island, w.f);
  any_motion(m, w);
  jacobian_rate(scene, *data.workspace, m.owner, w);
  w.kept.setZero(m.owner.island.size(), m.owner.island.nv);
  w.kept.bottomRows(m.owner.island.nc) = w.D;
  m.factor->project_out_panel(w.kept.data(), m.owner.island.nv, m.owner.island.nv);
  out.X.block(out.nv, out.q_first, out.nc, out.nv) += w.D - w.kept.bottomRows(m.owner.island.nc);  // += P D
}

void add_contradiction(const Scene& scene, SceneData& data, MatrixSystem& m, IslandDerivatives& out, PanelWork& work) {
  // J^T (J da + dr2) + dJ^T rho = 0 with rho = J a + a0, so J da = -dr2 - (J^T)^+ dJ^T rho on J's range. dJ^T rho is
  // what a force rho would add to -dr1.
  DependentDerivatives& w = *m.rows;
  const Linearisation& lin = *data.workspace->linearisation;
  IslandDerivatives& rho = w.with_rho;
  if (rho.X.rows() != m.owner.island.size()) lay_out(scene, m.owner.island, {true, false, false, false}, rho);
  w.with.setZero(data.f.size());
  double largest = 0, of_rho = 0;  // of what -dr1 is made of, and of rho
  for (int c : m.owner.island.contacts) {
    auto of_contact = w.with.segment(data.f_offset[c], scene.contacts[c].rows());
    of_contact = lin.contacts[c].W * lin.contacts[c].x;
    of_rho = std::max(of_rho, of_contact.cwiseAbs().maxCoeff());
    largest = std::max(largest, data.f.segment(data.f_offset[c], of_contact.size()).cwiseAbs().maxCoeff());
  }
  for (int r : m.owner.island.robots) largest = std::max(largest, data.workspace->robots[r].h.cwiseAbs().maxCoeff());
  // Beside forces of 1e4 N a rho of 1e-6 m/s^2 would be lost in their rounding: it is as large as they are.
  const double scale =
      of_rho > 0 && largest > of_rho ? std::exp2(std::min(std::ceil(std::log2(largest / of_rho)), 200.0)) : 1;
  w.with = data.f + scale * w.with;
  derivative_terms(scene, data, m.owner.island, w.with);
  rho.X.setZero();
  derivative_rhs(scene, lin, data.v, m.owner, rho);
  derivative_terms(scene, data, m.owner.island, data.f);
  rho.X.topLeftCorner(rho.nv, rho.nv) -= out.X.block(0, out.q_first, out.nv, out.nv);
  rho.X.topLeftCorner(rho.nv, rho.nv) /= scale;
  rho.X.bottomRows(rho.nc).setZero();
  solve_panel(scene, m, rho, work);  // M w + J^T phi = G, J w = 0: w = 0, phi of least norm
  out.X.block(out.nv, out.q_first, out.nc, out.nv) -= rho.X.block(rho.nv, 0, rho.nc, rho.nv);
}

}  // namespace manycontact::internal
