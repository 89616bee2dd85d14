
#include <cmath>
#include <stdexcept>

#include "attachment.hpp"
#include "manycontact/detail/model/inputs.hpp"
#include "manycontact/model/suggestion.hpp"

namespace manycontact {

namespace {

// Returns why x is invalid as the property `name` of a spring, or "" if it is valid.
std::string problem_of_number(const char* name, double x) {
  return x >= 0 && std::isfinite(x)
             ? ""
             : "has a " + std::string(name) + " that is not 0 or more, expected a finite number of 0 or more";
}

template <class Named>
int append(std::vector<Named>& list, std::unordered_map<std::string, int>& index, Named item, const char* what) {
  const int number = static_cast<int>(list.size());
  if (!index.emplace(item.name, number).second)
    throw std::invalid_argument(what + quote(item.name) + " exists already, expected names used once");
  list.push_back(std::move(item));
  return number;
}

}  // namespace

int add_external_wrench(Scene& scene, ExternalWrench push) {
  const auto refuse_if = [&](const std::string& what) {
    if (!what.empty()) throw std::invalid_argument("wrench " + quote(push.name) + " " + what);
  };
  refuse_if(problem(scene, push.at));
  if (push.at.robot < 0) refuse_if("is on the world, expected a body of a robot");
  if (push.at.joint < 0)
    refuse_if("is on " + describe(scene, push.at) + ", which cannot move, expected a body that moves");
  if (!push.wrench.allFinite()) refuse_if("has a force or torque that is not finite, expected finite numbers");
  return append(scene.wrenches, scene.wrench_index, std::move(push), "wrench ");
}

int add_spring(Scene& scene, Spring spring) {
  const auto refuse_if = [&](const std::string& what) {
    if (!what.empty()) throw std::invalid_argument("spring " + quote(spring.name) + " " + what);
  };
  for (const Attachment* end : {&spring.A, &spring.B}) refuse_if(problem(scene, *end));
  if (spring.A.robot == spring.B.robot && spring.A.joint == spring.B.joint && spring.A.robot >= 0)
    refuse_if("ties " + describe(scene, spring.A) + " to " + describe(scene, spring.B) +
              ", which are on one body, expected two bodies");
  for (Attachment* end : {&spring.A, &spring.B}) *end = world_if_immovable(scene, std::move(*end));
  if (spring.A.robot < 0) std::swap(spring.A, spring.B);
  if (spring.A.robot < 0) refuse_if("has both ends where nothing can move, expected an end on a body that moves");
  refuse_if(problem_of_number("stiffness", spring.stiffness));
  refuse_if(problem_of_number("length", spring.length));
  refuse_if(problem_of_number("damping", spring.damping));
  return append(scene.springs, scene.spring_index, std::move(spring), "spring ");
}

int add_joint_spring(Scene& scene, const std::string& robot, const std::string& joint, double stiffness, double rest) {
  (void)v_index(scene, robot, joint);  // throws if there is no such joint
  JointSpring spring{scene.robot_index.at(robot), 0, stiffness, rest};
  const Model& model = *scene.robots[spring.robot].model;
  spring.joint = model.find_joint(joint);
  const auto refuse_if = [&](const std::string& what) {
    if (!what.empty()) throw std::invalid_argument("joint " + quote(joint) + " of robot " + quote(robot) + " " + what);
  };
  if (model.joints[spring.joint].nv() != 1)
    refuse_if("has several coordinates, expected a joint that rotates about or slides along an axis");
  refuse_if(problem_of_number("stiffness", stiffness));
  if (!std::isfinite(rest)) refuse_if("has a rest position that is not finite, expected a finite number");
  scene.joint_springs.push_back(spring);
  return static_cast<int>(scene.joint_springs.size()) - 1;
}

void drop_applied_forces(Scene& scene) {
  scene.wrenches.clear();
  scene.springs.clear();
  scene.joint_springs.clear();
  scene.wrench_index.clear();
  scene.spring_index.clear();
}

void take_applied_forces(const Scene& from, const std::vector<int>& robot_at, Scene& to) {
  const auto move = [&](int& robot) {
    if (robot >= 0) robot = robot_at[static_cast<std::size_t>(robot)];
    return robot >= 0;
  };
  for (ExternalWrench push : from.wrenches) {
    if (!move(push.at.robot)) continue;
    to.wrench_index.emplace(push.name, static_cast<int>(to.wrenches.size()));
    to.wrenches.push_back(std::move(push));
  }
  for (Spring spring : from.springs) {
    const bool in_world = spring.B.robot < 0;
    if (!move(spring.A.robot) || (!move(spring.B.robot) && !in_world)) continue;
    to.spring_index.emplace(spring.name, static_cast<int>(to.springs.size()));
    to.springs.push_back(std::move(spring));
  }
  for (JointSpring spring : from.joint_springs)
    if (move(spring.robot)) to.joint_springs.push_back(spring);
}

std::vector<std::string> wrench_names(const Scene& scene) {
  std::vector<std::string> out;
  for (const ExternalWrench& push : scene.wrenches)
    for (int k = 0; k < 6; ++k) out.push_back(push.name + "[" + std::to_string(k) + "]");
  return out;
}

}  // namespace manycontact
