// Lengths and energies of springs, and the power of external wrenches and dampers.

#include <stdexcept>

#include "manycontact/algorithm/applied_forces.hpp"
#include "spring_end.hpp"

namespace manycontact {

AppliedPower power_of(const Scene& scene, const AppliedForces<double>& forces) {
  AppliedPower power;
  for (std::size_t k = 0; k < scene.wrenches.size(); ++k) {
    const Attachment& at = scene.wrenches[k].at;
    const int robot = forces.number[static_cast<std::size_t>(at.robot)];
    power.wrenches += forces.wrenches[k].dot(forces.robots[static_cast<std::size_t>(robot)].kin.v[at.joint]);
  }
  for (std::size_t k = 0; k < scene.springs.size(); ++k) {
    const double speed = forces.springs[k].n.dot(forces.springs[k].rate);
    power.dampers -= scene.springs[k].damping * speed * speed;
  }
  return power;
}

double spring_length(const Scene& scene, const ConstVectorRef& q, const Spring& spring) {
  if (q.size() != scene.nq) throw std::invalid_argument("spring_length: q has a wrong size, nq numbers are expected");
  const auto end = [&](const Attachment& at) {
    if (at.robot < 0) return spring_end<double>(at, nullptr);
    const Robot& robot = scene.robots[static_cast<std::size_t>(at.robot)];
    if (at.joint < 0) return spring_end<double>({-1, -1, robot.base * at.placement}, nullptr);
    Kinematics<double> kin(*robot.model);
    forward_kinematics<double>(*robot.model, robot.base, q.segment(robot.idx_q, robot.model->nq), kin);
    return spring_end<double>(at, &kin);
  };
  return between(end(spring.A), end(spring.B)).norm();
}

double energy_of_springs(const Scene& scene, const ConstVectorRef& q, const std::vector<Kinematics<double>>& kin) {
  double energy = 0;
  for (const Spring& spring : scene.springs) {
    const auto end = [&](const Attachment& at) {
      return spring_end<double>(at, at.robot < 0 ? nullptr : &kin[static_cast<std::size_t>(at.robot)]);
    };
    const double stretch = between(end(spring.A), end(spring.B)).norm() - spring.length;
    energy += 0.5 * spring.stiffness * stretch * stretch;
  }
  for (const JointSpring& spring : scene.joint_springs) {
    const Robot& robot = scene.robots[static_cast<std::size_t>(spring.robot)];
    const double stretch = q[robot.idx_q + robot.model->joints[spring.joint].idx_q] - spring.rest;
    energy += 0.5 * spring.stiffness * stretch * stretch;
  }
  return energy;
}

}  // namespace manycontact
