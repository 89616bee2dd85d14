#include "manycontact/io/scene_file.hpp"

#include <filesystem>

#include "manycontact/dynamics/quasi_static.hpp"
#include "scene_parts.hpp"

namespace manycontact {

SceneFile load_scene(const std::string& path) {
  std::string problem;
  const std::string text = io::read_file(path, problem);
  if (!problem.empty()) throw InputError(path, 1, problem + ", expected a scene file");
  const io::XmlFile file(path, text, "scene");
  const io::Element root = file.root();
  root.allow_attributes({"name", "gravity", "damping"});
  root.allow_children({"robot", "contact"});

  SceneFile out;
  out.path = path;
  out.scene.name = root.optional("name", std::filesystem::path(path).stem().string());
  if (const auto g = root.numbers<3>("gravity")) out.scene.gravity = Vec3<double>(g->data());
  out.scene.damping = root.number("damping", 0);
  if (out.scene.damping < 0)
    root.where("damping").fail("damping of <scene> is " + io::show(out.scene.damping) + ", expected 0 or more");

  std::vector<int> gravity_groups;
  io::add_robots(root, out, gravity_groups);
  io::add_contacts(root, out);
  if (!gravity_groups.empty()) {
    const Eigen::VectorXd u = quasi_static(out.scene, out.q);
    for (const int g : gravity_groups) {
      const RobotGroup& group = out.robot_groups[g];
      const Robot& first = out.scene.robots[group.first];
      const Eigen::Index n = Eigen::Index(group.count) * first.model->nu();  // the copies are neighbours
      out.u.segment(first.idx_u, n) = u.segment(first.idx_u, n);
    }
  }
  return out;
}

}  // namespace manycontact
