#include "manycontact/io/scene_file.hpp"

#include <algorithm>
#include <filesystem>
#include <set>

#include "scene_parts.hpp"

namespace manycontact {

namespace io {
namespace {

constexpr std::size_t kDeepestInclude = 16, kMostFiles = 1000;

Vec3<double> gravity_of(const Element& root) {
  Vec3<double> g = Scene().gravity;
  (void)root.read("gravity", g);
  return g;
}

bool consistent(const Element& root) { return root.flag("consistent", false); }

int restarts(const Element& root) { return root.has("restarts") ? root.count("restarts", 0, 1000000) : 0; }

class IncludeReader {  // reads a scene file and the files it includes, each in place of its <include>
 public:
  explicit IncludeReader(SceneElements& out) : out_(out) {}

  Element read(const std::string& path, const std::string& text) {
    out_.files.push_back(std::make_unique<XmlFile>(path, text, "scene"));
    const Element root = out_.files.back()->root();
    root.allow({"name", "gravity", "damping", "tolerance", "moment_length", "consistent", "restarts"},
               {"robot", "contact", "wrench", "push", "spring", "pose", "include"});
    for (const char* name : {"damping", "tolerance"}) (void)root.number_from_0(name, 0);  // refuses invalid numbers
    (void)root.positive("moment_length", 1, "a length");
    (void)consistent(root);
    (void)restarts(root);
    open_.push_back(canonical(path));
    for (const Element& e : root.children()) {
      if (e.name() == "include")
        include(e, root);
      else
        list_of(e.name()).push_back(e);
    }
    open_.pop_back();
    return root;
  }

 private:
  static std::string canonical(const std::string& path) {
    std::error_code failed;
    const auto found = std::filesystem::weakly_canonical(path, failed);
    return failed ? path : found.string();
  }

  std::vector<Element>& list_of(const std::string& name) {
    return name == "robot"    ? out_.robots
           : name == "pose"   ? out_.poses
           : name == "wrench" ? out_.wrenches
           : name == "push"   ? out_.wrenches
           : name == "spring" ? out_.springs
                              : out_.contacts;
  }

  void include(const Element& e, const Element& into) {
    e.allow({"file"});
    const Where here = e.where("file");
    const std::filesystem::path written = e.not_empty("file", "a scene file");
    const std::string path =
        written.is_absolute() ? written.string() : (std::filesystem::path(*here.file).parent_path() / written).string();
    if (std::ranges::count(open_, canonical(path)))
      here.fail("the scene file " + quote(path) + " includes itself, expected no cycle");
    if (open_.size() > kDeepestInclude)
      here.fail("scene files are included more than " + std::to_string(kDeepestInclude) +
                " levels deep, expected fewer levels");
    if (out_.files.size() >= kMostFiles)
      here.fail("more than " + std::to_string(kMostFiles) + " scene files are included, expected fewer files");
    std::string problem = file_problem(path, true);
    const std::string text = problem.empty() ? read_file(path, problem) : "";
    if (!problem.empty()) here.fail("the scene file " + quote(path) + " " + problem + ", expected a scene file");
    const Element root = read(path, text);
    if (root.has("gravity") && gravity_of(root) != gravity_of(into))
      root.where("gravity").fail("gravity differs from the gravity of the including scene, expected equal values");
    for (const char* name : {"damping", "tolerance", "moment_length"})
      if (const double usual = name == std::string("moment_length") ? 1 : 0;
          root.has(name) && root.number(name, usual) != into.number(name, usual))
        root.where(name).fail(std::string(name) +
                              " differs from the value in the including scene, expected equal values");
    if (consistent(root) && !consistent(into))
      root.where("consistent")
          .fail("consistent=\"true\" is missing in the including scene, expected consistent=\"true\" in both scenes");
  }

  SceneElements& out_;
  std::vector<std::string> open_;
};

std::vector<std::string> files_of(const SceneElements& elements, const std::vector<RobotGroup>& robots) {
  std::vector<std::string> files;
  std::set<std::string> known;
  const auto add = [&](const std::string& path) {
    if (known.insert(path).second) files.push_back(path);
  };
  for (const auto& file : elements.files) add(file->path());
  for (const RobotGroup& robot : robots) add(robot.urdf);
  return files;
}

SceneFile scene_of(const std::string& bytes, const std::string& path) {
  SceneElements elements;
  const Element root = IncludeReader(elements).read(path, bytes);

  SceneFile out;
  out.path = path;
  out.scene.name = root.optional("name", std::filesystem::path(path).stem().string());
  out.scene.gravity = gravity_of(root);
  out.scene.damping = root.number("damping", 0);
  out.scene.tolerance = root.number("tolerance", 0);
  out.scene.moment_length = root.number("moment_length", 1);
  if (consistent(root)) out.consistent_line = root.where("consistent").line;
  out.restarts = restarts(root);
  add_robots(elements.robots, out);
  out.files = files_of(elements, out.robot_groups);
  add_contacts(elements.contacts, out);
  add_wrenches(elements.wrenches, out);
  add_springs(elements.springs, out);
  add_joint_springs(elements.robots, out);
  add_poses(elements.poses, out);
  return out;
}

}  // namespace
}  // namespace io

SceneFile read_scene(const std::string& path) { return io::scene_of(io::read_file_of(path, "a scene file"), path); }

SceneFile read_scene_text(const std::string& text, const std::string& path) {
  constexpr const char* kUtf8Mark = "\xEF\xBB\xBF";  // takes precedence over a declaration of another encoding
  return io::scene_of(text.starts_with(kUtf8Mark) ? text : kUtf8Mark + text, path);
}

}  // namespace manycontact
