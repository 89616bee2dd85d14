#pragma once

#include "manycontact/model/scene.hpp"
#include "support/random.hpp"

namespace manycontact::test {

inline Attachment random_body(const Scene& scene, std::mt19937& rng) {
  const int robot = static_cast<int>(uniform(rng, 0, scene.nrobots() - 1e-9));
  const Model& model = *scene.robots[robot].model;
  return {robot, static_cast<int>(uniform(rng, 0, model.njoints() - 1e-9)), random_placement(rng, 0.3)};
}

/// Adds wrenches in the axes of bodies and of the world; springs to the world, within a robot and between robots, one
/// of zero length; springs in joints.
inline void add_random_forces(Scene& scene, std::mt19937& rng, int wrenches = 3, int springs = 5) {
  for (int k = 0; k < wrenches; ++k) {
    ExternalWrench push{"push" + std::to_string(k), random_body(scene, rng)};
    push.reference_frame = k % 2 == 0 ? ReferenceFrame::kLocal : ReferenceFrame::kWorld;
    push.wrench = random_vector(6, rng, 5);
    add_external_wrench(scene, push);
  }
  for (int k = 0; k < springs;) {
    Spring spring{"spring" + std::to_string(k), random_body(scene, rng), random_body(scene, rng)};
    if (k % 3 == 0) spring.B = {-1, -1, random_placement(rng, 1)};
    if (spring.A.robot == spring.B.robot && spring.A.joint == spring.B.joint) continue;
    spring.stiffness = uniform(rng, 5, 50);
    if (k != 1) spring.length = uniform(rng, 0.2, 1), spring.damping = uniform(rng, 0.1, 2);
    add_spring(scene, spring);
    ++k;
  }
  for (const Robot& robot : scene.robots)
    for (const Joint& joint : robot.model->joints)
      if (joint.nv() == 1 && chance(rng, 0.3))
        add_joint_spring(scene, robot.name, joint.name, uniform(rng, 1, 20), uniform(rng, -1, 1));
}

}  // namespace manycontact::test
