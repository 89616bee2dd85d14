#include "manycontact/simulation/spring_steps.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <limits>

#include "manycontact/simulation/resisting_joints.hpp"
#include "unit_forces.hpp"

namespace manycontact {

using internal::UnitForce;

namespace {

constexpr double kReachOfRk4 = 2.6;
constexpr int kMostAsked = 100;  // most joints with forces in a robot for which mobilities are computed

// Stiffness k and damping c of joint coordinates. Joint friction counts as a damper with its slope at zero velocity.
struct JointForces {
  Eigen::VectorXd k, c;
  JointForces(const Scene& scene, const PdLaws& pd) : k(Eigen::VectorXd::Zero(scene.nv)) {
    const internal::ResistingJoints joints(scene);
    internal::add_stiffness(scene, pd, 1, k);
    c = joints.damping + joints.friction / kFrictionVelocity;
    if (pd.kd.size() > 0) c += pd.kd;
  }
};

std::vector<int> joints_with_forces(const JointForces& forces) {
  std::vector<int> out;
  for (int i = 0; i < forces.k.size(); ++i)
    if (forces.k[i] > 0 || forces.c[i] > 0) out.push_back(i);
  return out;
}

// Makes three unit forces per spring and one per joint. More than kMostAsked joints of a robot get infinite mobility.
std::vector<UnitForce> all_forces(const Scene& scene, const PdLaws& pd, internal::UnitTorques& unit,
                                  Eigen::VectorXd& mobility_of_joints) {
  std::vector<UnitForce> out;
  for (std::size_t s = 0; s < scene.springs.size(); ++s)
    for (int k = 0; k < 3; ++k) unit.add_forces(static_cast<int>(s), Vec3<double>::Unit(k), out);
  const std::vector<int> joints = joints_with_forces(JointForces(scene, pd));
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
  if (integrator == Integrator::kSemiImplicitEuler)
    return k > 0 ? 2 / std::sqrt(k) : std::numeric_limits<double>::infinity();
  const double root = c * c - 4 * k;
  return kReachOfRk4 / (root > 0 ? (c + std::sqrt(root)) / 2 : std::sqrt(k));
}

SpringMobilities spring_mobilities(const Scene& scene, const PdLaws& pd, const std::vector<char>& active,
                                   const Eigen::VectorXd& q) {
  SpringMobilities out{std::vector<Mat3<double>>(scene.springs.size(), Mat3<double>::Zero()),
                       Eigen::VectorXd::Zero(scene.nv)};
  internal::UnitTorques unit(scene);
  unit.find_islands(scene, active);
  const std::vector<UnitForce> forces = all_forces(scene, pd, unit, out.joints);
  if (forces.empty()) return out;
  SceneAtRest rest(scene);
  rest.follow(scene, 0);  // zero gains: placement errors do not affect mobilities
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
          out.springs[force.spring].row(k) +=
              sound(unit.along(force.spring, Vec3<double>::Unit(k), force.island)) * force.direction.transpose();
    }
  }
  return out;
}

SpringStep shortest_spring_step(const Scene& scene, const PdLaws& pd, const std::vector<char>& active,
                                const Eigen::VectorXd& q, Integrator integrator) {
  SpringStep out;
  out.largest = std::numeric_limits<double>::infinity();
  const SpringMobilities mobilities = spring_mobilities(scene, pd, active, q);
  const auto take = [&](int spring, int coordinate, double k, double c) {
    if (!(k > 0 || c > 0) || std::isinf(k) || std::isinf(c)) return;
    if (const double step = largest_spring_step(integrator, k, c); step < out.largest) out = {spring, coordinate, step};
  };
  if (!scene.springs.empty()) {
    AppliedForces<double> at_q(scene);
    const Eigen::VectorXd rest = Eigen::VectorXd::Zero(scene.nv);
    std::vector<Vec6<double>> none(scene.wrenches.size(), Vec6<double>::Zero());
    find_applied_wrenches<double>(scene, q.data(), rest.data(), none, at_q);
    for (std::size_t s = 0; s < scene.springs.size(); ++s) {
      const Spring& spring = scene.springs[s];
      const Mat3<double>& C = mobilities.springs[s];
      const Vec3<double>& n = at_q.springs[s].n;
      const double mobility = n.isZero(0) ? C.selfadjointView<Eigen::Lower>().eigenvalues().maxCoeff() : n.dot(C * n);
      take(static_cast<int>(s), -1, spring.stiffness * mobility, spring.damping * mobility);
    }
  }
  const JointForces joints(scene, pd);
  for (int i = 0; i < scene.nv; ++i)
    take(-1, i, joints.k[i] * mobilities.joints[i], joints.c[i] * mobilities.joints[i]);
  return out;
}

}  // namespace manycontact
