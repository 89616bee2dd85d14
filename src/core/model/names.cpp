#include <stdexcept>

#include "manycontact/model/scene.hpp"
#include "manycontact/model/suggestion.hpp"

namespace manycontact {

namespace {

// Returns the names of coordinates of all, or only of actuated, joints. count(type): a joint's number of coordinates.
std::vector<std::string> names(const Scene& scene, int (*count)(JointType), bool actuated = false) {
  std::vector<std::string> out;
  for (const Robot& robot : scene.robots)
    for (const Joint& joint : robot.model->joints) {
      if (actuated && robot.model->torque_index(joint) < 0) continue;
      const int n = count(joint.type);
      for (int k = 0; k < n; ++k)
        out.push_back(robot.name + "/" + joint.name + (n > 1 ? "[" + std::to_string(k) + "]" : ""));
    }
  return out;
}

struct Place {
  const Robot& robot;
  const Joint& joint;
};

Place find(const Scene& scene, const std::string& robot, const std::string& joint) {
  const Robot& r = scene.robots[robot_called(scene, robot)];
  const int j = r.model->find_joint(joint);
  if (j < 0) throw std::invalid_argument("robot " + quote(robot) + ": " + no_joint(*r.model, joint));
  return {r, r.model->joints[j]};
}

}  // namespace

std::vector<std::string> configuration_names(const Scene& scene) { return names(scene, joint_nq); }
std::vector<std::string> velocity_names(const Scene& scene) { return names(scene, joint_nv); }
std::vector<std::string> torque_names(const Scene& scene) { return names(scene, joint_nv, true); }

int q_index(const Scene& scene, const std::string& robot, const std::string& joint) {
  const Place at = find(scene, robot, joint);
  return at.robot.idx_q + at.joint.idx_q;
}
int v_index(const Scene& scene, const std::string& robot, const std::string& joint) {
  const Place at = find(scene, robot, joint);
  return at.robot.idx_v + at.joint.idx_v;
}
int u_index(const Scene& scene, const std::string& robot, const std::string& joint) {
  const Place at = find(scene, robot, joint);
  const int u = at.robot.model->torque_index(at.joint);
  if (u < 0)
    throw std::invalid_argument("joint " + quote(joint) + " of robot " + quote(robot) + " is " +
                                (at.joint.actuated ? "its floating base" : "passive") +
                                ", which has no torques, expected an actuated joint");
  return at.robot.idx_u + u;
}

}  // namespace manycontact
