#include "manycontact/simulation/spring_steps.hpp"

#include <cmath>

#include "manycontact/algorithm/applied_forces.hpp"
#include "manycontact/model/applied_forces.hpp"

namespace manycontact {

namespace {

constexpr double kReachOfRk4 = 2.6;

// k and c over m.
double largest_step(Integrator integrator, double k, double c) {
  if (integrator == Integrator::kSemiImplicitEuler) return k > 0 ? (std::sqrt(c * c + 4 * k) - c) / k : 2 / c;
  const double root = c * c - 4 * k;
  return kReachOfRk4 / (root > 0 ? (c + std::sqrt(root)) / 2 : std::sqrt(k));
}

class UnitForces {
 public:
  UnitForces(const Scene& scene, const std::vector<char>& active, const Eigen::VectorXd& q)
      : scene_(scene), q_(q), alone_(scene), rest_(scene), data_(rest_.scene), tau_(scene.nv) {
    drop_applied_forces(alone_);
    data_.active = active;
  }

  // 1/m of a spring between two points; 0 where these coincide, or nothing moves.
  double mobility(Spring spring) {
    const double length = spring_length(scene_, q_, spring);
    if (length == 0) return 0;
    spring.stiffness = 1;
    spring.length = length - 1;  // it pulls by 1
    spring.damping = 0;
    alone_.springs.assign(1, spring);
    AppliedForces<double> forces(alone_);
    tau_.setZero();
    add_applied_forces<double>(alone_, q_.data(), rest_.zero.data(), {}, forces, tau_.data());
    return mobility();
  }
  double mobility(int coordinate) {
    tau_.setZero();
    tau_[coordinate] = 1;
    return mobility();
  }

 private:
  double mobility() {
    const bool failed = solve_tau(rest_.scene, q_, rest_.zero, tau_, data_).status == Status::kFailed;
    const double out = failed ? 0 : tau_.dot(data_.a);
    return out > 0 ? out : 0;
  }

  const Scene& scene_;
  const Eigen::VectorXd& q_;
  Scene alone_;
  SceneAtRest rest_;
  SceneData data_;
  Eigen::VectorXd tau_;
};

}  // namespace

SpringStep shortest_spring_step(const Scene& scene, const std::vector<char>& active, const Eigen::VectorXd& q,
                                Integrator integrator) {
  SpringStep out;
  if (scene.springs.empty() && scene.joint_springs.empty()) return out;
  UnitForces unit(scene, active, q);
  const auto take = [&](std::size_t spring, bool in_joint, double k, double c) {
    if (!(k > 0 || c > 0)) return;
    const double step = largest_step(integrator, k, c);
    if (out.spring < 0 || step < out.largest) out = {static_cast<int>(spring), in_joint, step};
  };
  for (std::size_t s = 0; s < scene.springs.size(); ++s) {
    const Spring& spring = scene.springs[s];
    const double mobility = unit.mobility(spring);
    take(s, false, spring.stiffness * mobility, spring.damping * mobility);
  }
  for (std::size_t s = 0; s < scene.joint_springs.size(); ++s) {
    const JointSpring& spring = scene.joint_springs[s];
    const Robot& robot = scene.robots[static_cast<std::size_t>(spring.robot)];
    const int i = robot.model->joints[spring.joint].idx_v;
    const double mobility = unit.mobility(robot.idx_v + i);
    const double c = robot.model->damping.size() > 0 ? robot.model->damping[i] : 0;
    take(s, true, spring.stiffness * mobility, c * mobility);
  }
  return out;
}

}  // namespace manycontact
