#include "manycontact/simulation/spring_steps.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <limits>

#include "unit_forces.hpp"

namespace manycontact {

using internal::UnitForce;

namespace {

constexpr double kReachOfRk4 = 2.6;
constexpr int kMostAsked = 100;  // joints of a robot

// Joint coordinates with a spring or a damper.
std::vector<int> joints_with_springs(const Scene& scene) {
  std::vector<char> has(static_cast<std::size_t>(scene.nv), 0);
  for (const JointSpring& spring : scene.joint_springs) {
    const Robot& robot = scene.robots[static_cast<std::size_t>(spring.robot)];
    has[static_cast<std::size_t>(robot.idx_v + robot.model->joints[spring.joint].idx_v)] = 1;
  }
  for (const Robot& robot : scene.robots)
    for (Eigen::Index i = 0; i < robot.model->damping.size(); ++i)
      if (robot.model->damping[i] > 0) has[static_cast<std::size_t>(robot.idx_v + i)] = 1;
  std::vector<int> out;
  for (int i = 0; i < scene.nv; ++i)
    if (has[static_cast<std::size_t>(i)]) out.push_back(i);
  return out;
}

// Three for each spring between points, one for each joint that is asked; the others get an infinite mobility.
std::vector<UnitForce> all_forces(const Scene& scene, internal::UnitTorques& unit, Eigen::VectorXd& mobility_of_joints) {
  std::vector<UnitForce> out;
  for (std::size_t s = 0; s < scene.springs.size(); ++s)
    for (int k = 0; k < 3; ++k) unit.add_forces(static_cast<int>(s), Vec3<double>::Unit(k), out);
  const std::vector<int> joints = joints_with_springs(scene);
  auto next = joints.begin();
  for (const Robot& robot : scene.robots) {
    const auto first = next;
    while (next != joints.end() && *next < robot.idx_v + robot.model->nv) ++next;
    for (auto i = first; i != next; ++i)
      if (next - first > kMostAsked)
        mobility_of_joints[*i] = std::numeric_limits<double>::infinity();
      else
        unit.add_force(scene, *i, out);
  }
  return out;
}

}  // namespace

double largest_spring_step(Integrator integrator, double k, double c) {
  if (integrator == Integrator::kSemiImplicitEuler) return k > 0 ? (std::sqrt(c * c + 4 * k) - c) / k : 2 / c;
  const double root = c * c - 4 * k;
  return kReachOfRk4 / (root > 0 ? (c + std::sqrt(root)) / 2 : std::sqrt(k));
}

SpringMobilities spring_mobilities(const Scene& scene, const std::vector<char>& active, const Eigen::VectorXd& q) {
  SpringMobilities out{std::vector<Mat3<double>>(scene.springs.size(), Mat3<double>::Zero()),
                       Eigen::VectorXd::Zero(scene.nv)};
  internal::UnitTorques unit(scene);
  unit.find_islands(scene, active);
  const std::vector<UnitForce> forces = all_forces(scene, unit, out.joints);
  if (forces.empty()) return out;
  SceneAtRest rest(scene);
  SceneData data(rest.scene);
  data.active = active;
  unit.place(scene, q);
  const auto sound = [](double x) { return std::isfinite(x) ? x : 0; };
  for (int number = 0; number < unit.numbers(); ++number) {
    unit.clear();
    for (const UnitForce& force : forces)
      if (force.number == number) unit.add(force, 1);
    (void)solve_tau(rest.scene, q, rest.zero, unit.torques(), data);
    unit.look(data.a);
    for (const UnitForce& force : forces) {
      if (force.number != number) continue;
      if (force.spring < 0)
        out.joints[force.coordinate] = std::max(0.0, sound(unit.along(force)));
      else
        for (int k = 0; k < 3; ++k)
          out.springs[static_cast<std::size_t>(force.spring)].row(k) +=
              sound(unit.along(force.spring, Vec3<double>::Unit(k), force.island)) * force.direction.transpose();
    }
  }
  return out;
}

SpringStep shortest_spring_step(const Scene& scene, const std::vector<char>& active, const Eigen::VectorXd& q,
                                Integrator integrator) {
  SpringStep out;
  if (scene.springs.empty() && scene.joint_springs.empty()) return out;
  const SpringMobilities mobilities = spring_mobilities(scene, active, q);
  const auto take = [&](std::size_t spring, bool in_joint, double k, double c) {
    if (!(k > 0 || c > 0) || std::isinf(k)) return;
    const double step = largest_spring_step(integrator, k, c);
    if (out.spring < 0 || step < out.largest) out = {static_cast<int>(spring), in_joint, step};
  };
  AppliedForces<double> at_q(scene);
  Eigen::VectorXd tau = Eigen::VectorXd::Zero(scene.nv);
  const Eigen::VectorXd rest = tau;
  std::vector<Vec6<double>> none(scene.pushes.size(), Vec6<double>::Zero());
  add_applied_forces<double>(scene, q.data(), rest.data(), none, at_q, tau.data());
  for (std::size_t s = 0; s < scene.springs.size(); ++s) {
    const Spring& spring = scene.springs[s];
    const Mat3<double>& C = mobilities.springs[s];
    const Vec3<double>& n = at_q.springs[s].n;
    const double mobility = n.isZero(0) ? C.selfadjointView<Eigen::Lower>().eigenvalues().maxCoeff() : n.dot(C * n);
    take(s, false, spring.stiffness * mobility, spring.damping * mobility);
  }
  for (std::size_t s = 0; s < scene.joint_springs.size(); ++s) {
    const JointSpring& spring = scene.joint_springs[s];
    const Robot& robot = scene.robots[static_cast<std::size_t>(spring.robot)];
    const int i = robot.model->joints[spring.joint].idx_v;
    const double mobility = mobilities.joints[robot.idx_v + i];
    const double c = robot.model->damping.size() > 0 ? robot.model->damping[i] : 0;
    take(s, true, spring.stiffness * mobility, c * mobility);
  }
  return out;
}

}  // namespace manycontact
