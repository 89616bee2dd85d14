#include "internal.hpp"

// With dependent rows the force of least norm stays in J's range: P f = 0 for the projector P = I - J J^+ on J^T's null
// space. Differentiated at constant rank, P df = P dJ y with y = J^+ f; dJ y is the derivative of J(q) y at constant y,
// that is, of the contacts' velocities when the joints move with y.

namespace manycontact::internal {

namespace {

using V6 = Vec6<double>;

// d(J(q) y)/dq, nc x nv.
Eigen::MatrixXd jacobian_rate(const Scene& scene, const SceneData& data, const IslandData& d, const Eigen::VectorXd& y) {
  const Island& island = d.island;
  std::vector<Kinematics<double>> kin;
  for (std::size_t k = 0; k < island.robots.size(); ++k) {
    const Robot& robot = scene.robots[island.robots[k]];
    kin.push_back(data.robots[island.robots[k]].kin);
    forward_accelerations<double>(*robot.model, y.segment(island.dof_offset[k], robot.model->nv), nullptr,
                                  scene.gravity, kin.back());
  }
  Eigen::MatrixXd D = Eigen::MatrixXd::Zero(island.nc, island.nv);
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
      const Vec3<double> th = terms.turn.col(i);
      V6 turned;
      turned << th.cross(nu.head<3>()), th.cross(nu.tail<3>());
      D.block(island.row_offset[c], island.dof_offset[a] + terms.chain_a[i], contact.rows(), 1).noalias() +=
          rows.W * turned;
    }
  }
  return D;
}

}  // namespace

void least_norm_forces(const Scene& scene, SceneData& data, const IslandData& d, IslandDerivatives& out) {
  const DenseKkt<double>& kkt = *d.dense;
  Eigen::VectorXd f(d.island.nc);
  for (std::size_t c = 0; c < d.island.contacts.size(); ++c) {
    const int n = scene.contacts[d.island.contacts[c]].rows();
    f.segment(d.island.row_offset[c], n) = data.f.segment(data.f_offset[d.island.contacts[c]], n);
  }
  const Eigen::VectorXd y = kkt.cod.transpose().solve(f);  // J^+ f
  const Eigen::MatrixXd D = jacobian_rate(scene, data, d, y);
  const Eigen::MatrixXd x = kkt.cod.transpose().solve(D);  // J^+ D
  out.X.block(out.nv, out.q_first, out.nc, out.nv) += D - kkt.J * x;
}

void add_contradiction(const Scene& scene, SceneData& data, const IslandData& d, IslandDerivatives& out) {
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
  out.X.block(out.nv, out.q_first, out.nc, out.nv) -= d.dense->cod.solve(G);
}

}  // namespace manycontact::internal
