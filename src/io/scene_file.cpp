#include "manycontact/io/scene_file.hpp"

#include <filesystem>

#include "scene_parts.hpp"

namespace manycontact {

SceneFile read_scene(const std::string& path) {
  std::string problem;
  const std::string text = io::read_file(path, problem);
  if (!problem.empty()) throw InputError(path, 1, problem + ", expected a scene file");
  return read_scene_text(text, path);
}

SceneFile read_scene_text(const std::string& text, const std::string& path) {
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

  io::add_robots(root, out);
  io::add_contacts(root, out);
  return out;
}

}  // namespace manycontact
