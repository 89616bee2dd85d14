#include "manycontact/dynamics/quasi_static.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "internal.hpp"
#include "manycontact/dynamics/give_up_solution.hpp"
#include "manycontact/model/expect_state.hpp"
#include "manycontact/rank/least_norm.hpp"

namespace manycontact {

namespace {

using Entries = std::vector<Eigen::Triplet<double>>;

// Returns upper bounds of the loads on a robot's coordinates. Gravity g loads coordinate i by at most |g| sqrt(m M_ii),
// m the mass that i moves (Cauchy-Schwarz). applied: sizes of wrench and spring torques per scene coordinate, or empty.
Eigen::VectorXd load_sizes(const Scene& scene, const Robot& robot, const std::vector<double>& M,
                           const std::vector<double>& applied) {
  const Model& model = *robot.model;
  Eigen::VectorXd mass = Eigen::VectorXd::Zero(model.njoints()), out(model.nv);
  for (int j = model.njoints() - 1; j >= 0; --j) {
    const Joint& joint = model.joints[j];
    mass[j] += joint.inertia.m;
    if (joint.parent >= 0) mass[joint.parent] += mass[j];
    for (int i = joint.idx_v; i < joint.idx_v + joint.nv(); ++i)
      out[i] =
          scene.gravity.norm() * std::sqrt(std::max(0.0, mass[j] * M[static_cast<std::size_t>(model.M_begin[i])])) +
          (applied.empty() ? 0 : applied[robot.idx_v + i]);
  }
  return out;
}

// Finds robots whose residual exceeds 1e-6 of the loads, i.e. what rounded numbers in files explain. Returns for each
// the coordinate with the largest ratio of residual to load. left: residual h - B u - J^T f of static equilibrium (nv).
std::vector<Unbalanced> unbalanced_robots(const Scene& scene, const Eigen::VectorXd& q, const SceneData& data,
                                          const Eigen::VectorXd& left) {
  constexpr double kRounded = 1e-6;
  const Workspace& w = *data.workspace;
  const Eigen::VectorXd rest = Eigen::VectorXd::Zero(scene.nv);
  std::vector<Unbalanced> out;
  for (const auto& d : w.islands) {
    std::vector<double> applied;
    if (internal::forces_are_applied(w))
      applied = applied_sizes(scene, q.data(), rest.data(), w.applied->forces, d->island.robots).tau;
    for (const int r : d->island.robots) {
      const Robot& robot = scene.robots[r];
      const Eigen::VectorXd sizes = load_sizes(scene, robot, w.robots[r].M, applied);
      Unbalanced worst{r};
      double part = kRounded;
      for (const Joint& joint : robot.model->joints)
        for (int k = 0; k < joint.nv(); ++k) {
          const int i = joint.idx_v + k;
          const double force = std::abs(left[robot.idx_v + i]);
          if (!(force > part * sizes[i])) continue;
          part = force / sizes[i];
          worst = {r, i, force, internal::is_angular(joint, k)};
        }
      if (worst.dof >= 0) out.push_back(worst);
    }
  }
  std::sort(out.begin(), out.end(), [](const Unbalanced& a, const Unbalanced& b) { return a.robot < b.robot; });
  return out;
}

Eigen::SparseMatrix<double> selection(const Scene& scene) {
  Eigen::SparseMatrix<double> S(scene.nv, scene.nu);
  for (const Robot& robot : scene.robots)
    for (int k = 0; k < robot.model->nu(); ++k) S.insert(robot.idx_v + robot.model->actuated[k], robot.idx_u + k) = 1;
  return S;
}

// Implements all overloads of quasi_static. unbalanced: output, or nullptr.
Eigen::VectorXd least_norm_torques(const Scene& scene, const ConstVectorRef& q, const ConstVectorRef& tau0,
                                   const Eigen::SparseMatrix<double>& B, SceneData& data,
                                   std::vector<Unbalanced>* unbalanced) {
  internal::check_scene(scene, data, "quasi_static");
  expect_configuration("quasi_static", "q", q, scene);
  internal::check_size("quasi_static", "tau0", tau0.size(), scene.nv);
  internal::check_size("quasi_static", "a column of B", B.rows(), scene.nv);
  prepare(scene, data);
  give_up_solution(data);  // evaluations below overwrite terms at the solution
  internal::prepare_islands(scene, data);
  Workspace& w = *data.workspace;
  const int nu = static_cast<int>(B.cols());
  const Eigen::VectorXd rest = Eigen::VectorXd::Zero(scene.nv);
  Eigen::VectorXd h = -tau0;
  Entries A;  // [B J^T]
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
  const Eigen::VectorXd x = rank::least_norm_solution(scene.nv, nu + static_cast<int>(data.f.size()), A, h);
  if (unbalanced) {
    for (const auto& a : A) h[a.row()] -= a.value() * x[a.col()];
    *unbalanced = unbalanced_robots(scene, q, data, h);
  }
  return x.head(nu);
}

}  // namespace

Eigen::VectorXd quasi_static(const Scene& scene, const Eigen::Ref<const Eigen::VectorXd>& q,
                             const Eigen::Ref<const Eigen::VectorXd>& tau0, const Eigen::SparseMatrix<double>& B,
                             SceneData& data) {
  return least_norm_torques(scene, q, tau0, B, data, nullptr);
}

Eigen::VectorXd quasi_static(const Scene& scene, const Eigen::Ref<const Eigen::VectorXd>& q, SceneData& data) {
  return quasi_static(scene, q, Eigen::VectorXd::Zero(scene.nv), selection(scene), data);
}

Eigen::VectorXd quasi_static(const Scene& scene, const Eigen::Ref<const Eigen::VectorXd>& q,
                             std::vector<Unbalanced>* unbalanced) {
  SceneData data(scene);
  return least_norm_torques(scene, q, Eigen::VectorXd::Zero(scene.nv), selection(scene), data, unbalanced);
}

}  // namespace manycontact
