#include "internal.hpp"

// With dependent rows the force of least norm stays in J's range: P f = 0 for the projector P = I - J J^+ on J^T's null
// space. Differentiated at constant rank, P df = P dJ y with y = J^+ f; dJ y is the derivative of J(q) y at constant y,
// that is, of the contacts' velocities when the joints move with y.

namespace manycontact::internal {

namespace {

using V6 = Vec6<double>;

using RowMajor = IslandDerivatives::Panel;

// A y with J y = f, f in J's range. (Which one does not matter: d(J n) = 0 along J n = 0.)
Eigen::VectorXd any_motion(IslandData& d, const Eigen::VectorXd& f) {
  if (d.factor == Factor::kDense) return d.dense->cod.transpose().solve(f);  // J^+ f
  const int* iperm = d.system.pattern->iperm.data();
  Eigen::VectorXd x = Eigen::VectorXd::Zero(d.island.size()), y(d.island.nv);
  for (int k = 0; k < d.island.nc; ++k) x[iperm[d.island.nv + k]] = f[k];
  sparse::ldl_solve(d.system.pattern->ldl, d.Lx.data(), d.D.data(), x.data());
  for (int k = 0; k < d.island.nv; ++k) y[k] = x[iperm[k]];
  return y;
}

// The least-norm phi with J^T phi = G (nv x k), G in J^T's range.
Eigen::MatrixXd forces_behind(const Scene& scene, SceneData& data, IslandData& d, const Eigen::MatrixXd& G) {
  if (d.factor == Factor::kDense) return d.dense->cod.solve(G);
  IslandDerivatives panel;
  panel.cols = static_cast<int>(G.cols());
  panel.X.setZero(d.island.size(), (panel.cols + 7) / 8 * 8);
  panel.X.topLeftCorner(d.island.nv, G.cols()) = G;
  solve_panel(scene, data, d, panel);  // M w + J^T phi = G, J w = 0: w = 0
  return panel.X.bottomRows(d.island.nc).leftCols(G.cols());
}

// d(J(q) y)/dq, nc x nv.
RowMajor jacobian_rate(const Scene& scene, const SceneData& data, const IslandData& d, const Eigen::VectorXd& y) {
  const Island& island = d.island;
  std::vector<Kinematics<double>> kin;
  for (std::size_t k = 0; k < island.robots.size(); ++k) {
    const Robot& robot = scene.robots[island.robots[k]];
    kin.push_back(data.robots[island.robots[k]].kin);
    forward_accelerations<double>(*robot.model, y.segment(island.dof_offset[k], robot.model->nv), nullptr,
                                  scene.gravity, kin.back());
  }
  RowMajor D = RowMajor::Zero(island.nc, island.nv);
  for (std::size_t c = 0; c < island.contacts.size(); ++c) {
    const Contact& contact = scene.contacts[island.contacts[c]];
    const ContactSupport& support = data.supports[island.contacts[c]];
    const ContactData<double>& rows = data.derivatives->rows[island.contacts[c]];
    const ContactDerivatives& terms = data.derivatives->contacts[island.contacts[c]];
    const int a = local_robot(island, contact.A.robot), b = contact.B.robot < 0 ? -1 : local_robot(island, contact.B.robot);
    V6 vB = V6::Zero(), nu = V6::Zero();
    if (b >= 0 && contact.B.joint >= 0) vB = rows.bMA.act_inverse(kin[b].v[contact.B.joint]);
    int k = 0;
    const auto column = [&](int robot, int i, const SE3<double>& M, double sign) {
      const Model& model = *scene.robots[island.robots[robot]].model;
      const int parent = model.joints[model.dof_joint[i]].parent;
      const V6 s = rows.Jl.col(k);
      V6 dnu = cross_motion(s, vB);
      if (parent >= 0) dnu += sign * M.act_inverse(cross_motion(kin[robot].v[parent], kin[robot].J.col(i)));
      const int col = d.support.columns[c][k];
      D.block(island.row_offset[c], col, contact.rows(), 1).noalias() += rows.W * dnu;
      nu += s * y[col];
      ++k;
    };
    for (int i : support.a) column(a, i, rows.aMA, 1);
    for (int i : support.b) column(b, i, rows.bMA, -1);
    if (!terms.turns) continue;
    for (std::size_t i = 0; i < terms.chain_a.size(); ++i) {
      const V6 dnu = turned(terms.turn.col(i), nu);
      D.block(island.row_offset[c], island.dof_offset[a] + terms.chain_a[i], contact.rows(), 1).noalias() +=
          rows.W * dnu;
    }
  }
  return D;
}

}  // namespace

void least_norm_forces(const Scene& scene, SceneData& data, IslandData& d, IslandDerivatives& out) {
  Eigen::VectorXd f(d.island.nc);
  for (std::size_t c = 0; c < d.island.contacts.size(); ++c) {
    const int n = scene.contacts[d.island.contacts[c]].rows();
    f.segment(d.island.row_offset[c], n) = data.f.segment(data.f_offset[d.island.contacts[c]], n);
  }
  RowMajor D = jacobian_rate(scene, data, d, any_motion(d, f));
  if (d.factor == Factor::kDense) {
    const Eigen::MatrixXd x = d.dense->cod.transpose().solve(Eigen::MatrixXd(D));  // J^+ D
    out.X.block(out.nv, out.q_first, out.nc, out.nv) += D - d.dense->J * x;
    return;
  }
  // D - (I - P) D
  RowMajor kept = RowMajor::Zero(d.island.size(), d.island.nv);
  kept.bottomRows(d.island.nc) = D;
  sparse::project_out_panel(d.rows, d.system.pattern->perm.data(), kept.data(),
                            d.island.nv, 0, d.island.nv);
  out.X.block(out.nv, out.q_first, out.nc, out.nv) += D - kept.bottomRows(d.island.nc);
}

void add_contradiction(const Scene& scene, SceneData& data, IslandData& d, IslandDerivatives& out) {
  // J^T (J da + dr2) + dJ^T rho = 0 with rho = J a + a0, so J da = -dr2 - (J^T)^+ dJ^T rho on J's range. dJ^T rho is what
  // a force rho would add to -dr1.
  const DerivativeData& dd = *data.derivatives;
  const Eigen::VectorXd f = data.f;
  for (int c : d.island.contacts)
    data.f.segment(data.f_offset[c], scene.contacts[c].rows()) += dd.rows[c].W * dd.contacts[c].x;
  IslandDerivatives with_rho = out;
  derivative_terms(scene, data, d);
  derivative_rhs(scene, data, d, with_rho);
  data.f = f;
  derivative_terms(scene, data, d);
  const Eigen::MatrixXd G = with_rho.X.block(0, out.q_first, out.nv, out.nv) - out.X.block(0, out.q_first, out.nv, out.nv);
  out.X.block(out.nv, out.q_first, out.nc, out.nv) -= forces_behind(scene, data, d, G);
}

}  // namespace manycontact::internal
