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

// P (dJ y), nc x nv; empty where the rows are independent.
Eigen::MatrixXd correction(const Scene& scene, SceneData& data, const IslandData& d) {
  const DenseKkt<double>& kkt = *d.dense;
  if (kkt.delta > 0 || kkt.rank == kkt.nc()) return {};
  Eigen::VectorXd f(d.island.nc);
  for (std::size_t c = 0; c < d.island.contacts.size(); ++c) {
    const int n = scene.contacts[d.island.contacts[c]].rows();
    f.segment(d.island.row_offset[c], n) = data.f.segment(data.f_offset[d.island.contacts[c]], n);
  }
  const Eigen::VectorXd y = kkt.cod.transpose().solve(f);  // J^+ f
  const Eigen::MatrixXd D = jacobian_rate(scene, data, d, y);
  const Eigen::MatrixXd x = kkt.cod.transpose().solve(D);  // J^+ D
  return D - kkt.J * x;
}

// The correction outside of differentiate, whose terms it needs.
Eigen::MatrixXd correction_of_product(const Scene& scene, SceneData& data, const IslandData& d) {
  if (!data.derivatives) data.derivatives = std::make_unique<DerivativeData>(scene, data.supports);
  derivative_terms(scene, data, d);
  return correction(scene, data, d);
}

}  // namespace

void least_norm_forces(const Scene& scene, SceneData& data, const IslandData& d, IslandDerivatives& out) {
  const Eigen::MatrixXd PD = correction(scene, data, d);
  if (PD.size() > 0) out.X.block(out.nv, out.q_first, out.nc, out.nv) += PD;
}

void least_norm_jvp(const Scene& scene, SceneData& data, const IslandData& d, const ConstVector& dq,
                    Eigen::Ref<Eigen::VectorXd> df) {
  const Eigen::MatrixXd PD = correction_of_product(scene, data, d);
  if (PD.size() == 0) return;
  Eigen::VectorXd x(d.island.nv);
  for (std::size_t k = 0; k < d.island.robots.size(); ++k) {
    const Robot& robot = scene.robots[d.island.robots[k]];
    x.segment(d.island.dof_offset[k], robot.model->nv) = dq.segment(robot.idx_v, robot.model->nv);
  }
  const Eigen::VectorXd y = PD * x;
  for (std::size_t c = 0; c < d.island.contacts.size(); ++c) {
    const int n = scene.contacts[d.island.contacts[c]].rows();
    df.segment(data.f_offset[d.island.contacts[c]], n) += y.segment(d.island.row_offset[c], n);
  }
}

void least_norm_vjp(const Scene& scene, SceneData& data, const IslandData& d, const ConstVector& wf,
                    Eigen::Ref<Eigen::VectorXd> wq) {
  const Eigen::MatrixXd PD = correction_of_product(scene, data, d);
  if (PD.size() == 0) return;
  Eigen::VectorXd y(d.island.nc);
  for (std::size_t c = 0; c < d.island.contacts.size(); ++c) {
    const int n = scene.contacts[d.island.contacts[c]].rows();
    y.segment(d.island.row_offset[c], n) = wf.segment(data.f_offset[d.island.contacts[c]], n);
  }
  const Eigen::VectorXd x = PD.transpose() * y;
  for (std::size_t k = 0; k < d.island.robots.size(); ++k) {
    const Robot& robot = scene.robots[d.island.robots[k]];
    wq.segment(robot.idx_v, robot.model->nv) += x.segment(d.island.dof_offset[k], robot.model->nv);
  }
}

}  // namespace manycontact::internal
