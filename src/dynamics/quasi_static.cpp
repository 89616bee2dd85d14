#include "manycontact/dynamics/quasi_static.hpp"

#include <Eigen/QR>
#include <limits>

#include "internal.hpp"

namespace manycontact {

namespace {

// The torques of one island into tau (scene.nv); with `bases`, floating bases are actuated too.
void hold_island(const Scene& scene, const SceneData& data, const IslandData& d, bool bases, Eigen::VectorXd& tau) {
  const Island& island = d.island;
  const auto first = [&](int r) { return bases ? 0 : scene.robots[r].model->first_actuated(); };
  int nu = 0;
  for (int r : island.robots) nu += scene.robots[r].model->nv - first(r);
  if (nu + island.nc == 0) return;  // a free object: nothing to choose
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(island.nv, nu + island.nc);  // [S^T J^T]
  Eigen::VectorXd h(island.nv);
  int column = 0;
  for (std::size_t k = 0; k < island.robots.size(); ++k) {
    const Model& model = *scene.robots[island.robots[k]].model;
    h.segment(island.dof_offset[k], model.nv) = data.robots[island.robots[k]].h;
    for (int i = first(island.robots[k]); i < model.nv; ++i) A(island.dof_offset[k] + i, column++) = 1;
  }
  for (std::size_t c = 0; c < island.contacts.size(); ++c) {
    const Eigen::MatrixXd& J = data.contacts[island.contacts[c]].J;
    for (int j = 0; j < J.cols(); ++j)
      A.row(d.support.columns[c][j]).segment(nu + island.row_offset[c], J.rows()) = J.col(j).transpose();
  }
  const Eigen::VectorXd x = A.completeOrthogonalDecomposition().solve(h);
  column = 0;
  for (int r : island.robots) {
    const int n = scene.robots[r].model->nv - first(r);
    tau.segment(scene.robots[r].idx_v + first(r), n) = x.segment(column, n);
    column += n;
  }
}

Eigen::VectorXd hold(const Scene& scene, const Eigen::Ref<const Eigen::VectorXd>& q, bool bases, SceneData& data) {
  if (q.size() != scene.nq)
    throw std::invalid_argument("quasi_static: q has " + std::to_string(q.size()) + " numbers, the scene expects " +
                                std::to_string(scene.nq));
  prepare(scene, data);
  data.solved = false;  // its kinematics are overwritten
  const Eigen::VectorXd rest = Eigen::VectorXd::Zero(scene.nv);
  Eigen::VectorXd tau = rest;
  for (IslandData& d : data.islands) {
    d.factor = Factor::kNone;
    internal::evaluate(scene, q, rest, data, d.island);
    if (internal::check_input(scene, q, rest, rest, d.island) != Reason::kNone) {
      for (int r : d.island.robots)
        tau.segment(scene.robots[r].idx_v, scene.robots[r].model->nv).setConstant(std::numeric_limits<double>::quiet_NaN());
    } else if (d.island.nv > 0) {
      hold_island(scene, data, d, bases, tau);
    }
  }
  return tau;
}

}  // namespace

Eigen::VectorXd quasi_static(const Scene& scene, const Eigen::Ref<const Eigen::VectorXd>& q, SceneData& data) {
  const Eigen::VectorXd tau = hold(scene, q, false, data);
  Eigen::VectorXd u(scene.nu);
  for (const Robot& robot : scene.robots)
    u.segment(robot.idx_u, robot.model->nu()) =
        tau.segment(robot.idx_v + robot.model->first_actuated(), robot.model->nu());
  return u;
}

Eigen::VectorXd quasi_static_tau(const Scene& scene, const Eigen::Ref<const Eigen::VectorXd>& q, SceneData& data) {
  return hold(scene, q, true, data);
}

Eigen::VectorXd quasi_static(const Scene& scene, const Eigen::Ref<const Eigen::VectorXd>& q) {
  SceneData data(scene);
  return quasi_static(scene, q, data);
}

}  // namespace manycontact
