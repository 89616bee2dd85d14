#include "manycontact/dynamics/quasi_static.hpp"

#include <limits>

#include "internal.hpp"
#include "manycontact/dynamics/give_up_solution.hpp"
#include "manycontact/model/expect_state.hpp"
#include "manycontact/rank/least_norm.hpp"

namespace manycontact {

Eigen::VectorXd quasi_static(const Scene& scene, const Eigen::Ref<const Eigen::VectorXd>& q,
                             const Eigen::Ref<const Eigen::VectorXd>& tau0, const Eigen::SparseMatrix<double>& B,
                             SceneData& data) {
  internal::check_scene(scene, data, "quasi_static");
  expect_configuration("quasi_static", "q", q, scene);
  internal::check_size("quasi_static", "tau0", tau0.size(), scene.nv);
  internal::check_size("quasi_static", "a column of B", B.rows(), scene.nv);
  prepare(scene, data);
  give_up_solution(data);  // its kinematics are overwritten
  internal::prepare_islands(scene, data);
  Workspace& w = *data.workspace;
  const int nu = static_cast<int>(B.cols());
  const Eigen::VectorXd rest = Eigen::VectorXd::Zero(scene.nv);
  Eigen::VectorXd h = -tau0;
  std::vector<Eigen::Triplet<double>> A;  // [B J^T]
  for (int u = 0; u < nu; ++u)
    for (Eigen::SparseMatrix<double>::InnerIterator it(B, u); it; ++it) A.emplace_back(it.row(), u, it.value());
  Eigen::VectorXd applied = Eigen::VectorXd::Zero(scene.nv);
  internal::check_pushes(scene, data, "quasi_static");
  internal::add_applied_forces(scene, data, q.data(), rest.data(), applied.data());
  h -= applied;
  ++w.state;
  for (const auto& d : w.islands) {
    const Island& island = d->island;
    internal::check_joint_space(*d, "quasi_static", "");
    internal::make_joint_space(scene, w, *d);
    internal::evaluate(scene, q, rest, w, island);
    const bool usable = internal::check_input(scene, q, rest, rest, island) == Reason::kNone;
    for (int r : island.robots) {
      auto of_robot = h.segment(scene.robots[r].idx_v, scene.robots[r].model->nv);
      of_robot += w.robots[r].h;
      if (!usable) of_robot.setConstant(std::numeric_limits<double>::quiet_NaN());
    }
    for (int c : island.contacts) {
      const Contact& contact = scene.contacts[c];
      const Eigen::MatrixXd& J = w.contacts[c].J;
      int column = 0;
      const auto add = [&](int robot, int i) {
        for (Eigen::Index row = 0; row < J.rows(); ++row)
          A.emplace_back(scene.robots[robot].idx_v + i, nu + data.f_offset[c] + row, J(row, column));
        ++column;
      };
      for (int i : w.supports[c].a) add(contact.A.robot, i);
      for (int i : w.supports[c].b) add(contact.B.robot, i);
    }
  }
  return rank::least_norm_solution(scene.nv, nu + static_cast<int>(data.f.size()), A, h).head(nu);
}

Eigen::VectorXd quasi_static(const Scene& scene, const Eigen::Ref<const Eigen::VectorXd>& q, SceneData& data) {
  Eigen::SparseMatrix<double> S(scene.nv, scene.nu);
  for (const Robot& robot : scene.robots)
    for (int k = 0; k < robot.model->nu(); ++k) S.insert(robot.idx_v + robot.model->actuated[k], robot.idx_u + k) = 1;
  return quasi_static(scene, q, Eigen::VectorXd::Zero(scene.nv), S, data);
}

Eigen::VectorXd quasi_static(const Scene& scene, const Eigen::Ref<const Eigen::VectorXd>& q) {
  SceneData data(scene);
  return quasi_static(scene, q, data);
}

}  // namespace manycontact
