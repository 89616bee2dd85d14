#include "describe.hpp"
#include "manycontact/algorithm/applied_forces.hpp"
#include "manycontact/detail/algorithm/frames.hpp"
#include "manycontact/detail/model/inputs.hpp"
#include "table.hpp"

namespace manycontact::cli {

namespace {

constexpr std::size_t kMostListed = 24;  // most rows of a table

std::string three(const Vec3<double>& x) { return number(x[0]) + " " + number(x[1]) + " " + number(x[2]); }

std::string name_of(const Scene& scene, const Attachment& at) {
  if (at.robot < 0) return "the world";
  const Robot& robot = scene.robots[at.robot];
  return robot.name + "/" + (at.frame.empty() ? robot.model->joints[at.joint].name : at.frame);
}

struct At {  // external wrenches and springs at q and v of the scene file
  const Scene& scene;
  AppliedForces<double> forces;

  explicit At(const SceneFile& file) : scene(file.scene), forces(scene) {
    find_applied_wrenches<double>(scene, file.q.data(), file.v.data(), external_wrenches(scene), forces);
  }
  Vec3<double> place(const Attachment& at) const {
    if (at.robot < 0) return at.placement.p;
    const Robot& robot = scene.robots[at.robot];
    const auto& of = forces.robots[forces.number[at.robot]];
    return frame_placement<double>(of.kin, robot.base, at.joint, at.placement).p;
  }
};

void print_wrenches(std::ostream& out, const Scene& scene, const At& at) {
  if (scene.wrenches.empty()) return;
  out << "\nExternal wrenches: point of action [m], force [N] and torque [N m]\n";
  Table table("wrench<|on<|at|force|torque|axes<", kMostListed);
  for (const ExternalWrench& push : scene.wrenches)
    table.add({push.name, name_of(scene, push.at), three(at.place(push.at)), three(push.wrench.head<3>()),
               three(push.wrench.tail<3>()), push.reference_frame == ReferenceFrame::kLocal ? "local" : "world"});
  table.print(out);
}

void print_springs(std::ostream& out, const Scene& scene, const At& at) {
  if (scene.springs.empty()) return;
  out << "\nSprings: ends [m], length and length at rest [m], force [N] (positive: pulls the ends together)\n";
  Table table("spring<|on<|at|to<|at|length|at rest|force", kMostListed);
  for (std::size_t k = 0; k < scene.springs.size(); ++k) {
    const Spring& spring = scene.springs[k];
    const auto& now = at.forces.springs[k];
    table.add({spring.name, name_of(scene, spring.A), three(at.place(spring.A)), name_of(scene, spring.B),
               three(at.place(spring.B)), number(now.length), number(spring.length),
               number(spring.stiffness * now.length + now.t)});
  }
  table.print(out);
}

void print_joint_springs(std::ostream& out, const SceneFile& file) {
  const Scene& scene = file.scene;
  if (scene.joint_springs.empty()) return;
  out << "\nSprings in joints: position and position at rest [rad, m], torque [N m, N]\n";
  Table table("joint<|at|at rest|torque", kMostListed);
  for (const JointSpring& spring : scene.joint_springs) {
    const Robot& robot = scene.robots[spring.robot];
    const Joint& joint = robot.model->joints[spring.joint];
    const double q = file.q[robot.idx_q + joint.idx_q];
    table.add(
        {robot.name + "/" + joint.name, number(q), number(spring.rest), number(-spring.stiffness * (q - spring.rest))});
  }
  table.print(out);
}

}  // namespace

void print_applied_forces(std::ostream& out, const SceneFile& file) {
  const At at(file);
  print_wrenches(out, file.scene, at);
  print_springs(out, file.scene, at);
  print_joint_springs(out, file);
}

}  // namespace manycontact::cli
