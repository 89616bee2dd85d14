#include <cmath>
#include <map>

#include "../text/table.hpp"
#include "inspect.hpp"

namespace manycontact::cli {

namespace {

constexpr std::size_t kMostJoints = 48;

const char* type_name(const Joint& joint) {
  constexpr const char* kNames[] = {"revolute", "prismatic", "floating", "planar"};
  return kNames[static_cast<int>(joint.type)];
}

std::string bound(const Eigen::VectorXd& limits, int k) {  // limit k as text, or "" if there is none
  return limits.size() > k && std::isfinite(limits[k]) ? number(limits[k], 4) : "";
}

}  // namespace

void print_joints(std::ostream& out, const SceneFile& file) {
  Table table("robot<24|joint<30|type<|lower|upper|velocity|effort|armature|<", kMostJoints);
  std::map<const Model*, bool> shown;
  for (const RobotGroup& group : file.robot_groups) {
    const Model& model = *file.scene.robots[group.first].model;
    if (!shown.emplace(&model, true).second) continue;
    for (const Joint& joint : model.joints) {
      if (joint.type == JointType::kFloating) continue;
      for (int k = 0; k < joint.nv(); ++k) {
        const int i = joint.idx_v + k;
        table.add({group_name(group), dof_name(model, i), type_name(joint), bound(joint.lower, k),
                   bound(joint.upper, k), bound(joint.velocity_limit, k), bound(joint.effort_limit, k),
                   model.armature[i] > 0 ? number(model.armature[i]) : "", joint.actuated ? "" : "passive"});
      }
    }
  }
  if (table.empty()) return;
  out << "\nJoints: limits of the robots' files [rad or m, rad/s or m/s, N m or N], armature [kg m^2 or kg]\n";
  table.print(out);
}

}  // namespace manycontact::cli
