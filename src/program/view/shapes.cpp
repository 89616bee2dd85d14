// Finds the shapes of robots: the visuals of their URDF files, or capsules between joints for bodies without visuals.

#include <map>
#include <set>
#include <unordered_map>

#include "manycontact/analysis/text.hpp"
#include "manycontact/io/input_error.hpp"
#include "manycontact/io/visuals.hpp"
#include "mesh.hpp"
#include "page.hpp"

namespace manycontact::cli {

namespace {

constexpr std::size_t kMostTriangles = 4000;  // meshes with more triangles are decimated

constexpr const char* kNames[] = {"box", "cylinder", "sphere", "mesh"};

Json json_of(const SE3<double>& at) {
  const auto q = quaternion_of_rotation<double>(at.R);
  Json list = Json::array();
  for (const double x : at.p) list.push_back(static_cast<float>(x));
  for (const double x : q) list.push_back(static_cast<float>(x));
  return list;
}

struct Meshes {  // the meshes of a scene, each once
  Json list = Json::array();
  std::map<std::string, int> index;  // key: path; value: position in `list`, or -1 if the mesh cannot be read
  std::set<std::string> lost;        // names of missing meshes as in the URDF, and the reasons
};

int mesh_number(const std::string& urdf, const std::string& name, Meshes& meshes) {  // -1: the mesh cannot be read
  const std::string path = find_mesh(urdf, name);
  if (path.empty()) {
    meshes.lost.insert(name + " (not found)");
    return -1;
  }
  const auto [at, is_new] = meshes.index.emplace(path, -1);
  if (!is_new) return at->second;
  try {
    const Mesh mesh = decimate(load_mesh(path), kMostTriangles);
    std::vector<float> vertices;
    std::vector<std::uint32_t> triangles;
    for (const auto& v : mesh.vertices) vertices.insert(vertices.end(), v.begin(), v.end());
    for (const auto& t : mesh.triangles) triangles.insert(triangles.end(), t.begin(), t.end());
    at->second = static_cast<int>(meshes.list.size());
    meshes.list.push_back({{"vertices", base64_of(vertices)}, {"triangles", base64_of(triangles)}});
  } catch (const InputError& error) {
    meshes.lost.insert(error.what());
  }
  return at->second;
}

// Returns a capsule from the body's origin to p, in the body's frame, or a ball if p is the origin. The centre of its
// half ball is at p, or, with `ends`, the outermost point of the half ball is at p.
Json capsule(int body, Vec3<double> p, double radius, bool ends) {
  if (ends && p.norm() > 0) p *= 1 - radius / p.norm();
  const double length = p.norm();
  SE3<double> at;
  at.p = p / 2;
  if (length > 0) at.R = Eigen::Quaterniond::FromTwoVectors(Vec3<double>::UnitZ(), p).toRotationMatrix();
  return {{"body", body}, {"shape", "capsule"}, {"size", {radius, length, 0}}, {"at", json_of(at)}};
}

// Returns the largest sum of the distances between joints along a chain, to which capsules are scaled.
double reach_of(const Model& model) {
  double longest = 0;
  std::vector<double> reach(model.joints.size());
  for (std::size_t i = 0; i < model.joints.size(); ++i) {
    const Joint& joint = model.joints[i];
    if (joint.parent >= 0) reach[i] = reach[joint.parent] + joint.placement.p.norm();
    longest = std::max(longest, reach[i]);
  }
  return longest;
}

// Returns the end of a leaf body: its farthest frame, or twice the centre of mass if all frames are nearer than that.
Vec3<double> tip_of(const Model& model, int joint) {
  const Inertia<double>& Y = model.joints[joint].inertia;
  const Vec3<double> centre = Y.m > 0 ? Vec3<double>(Y.h / Y.m) : Vec3<double>::Zero();
  Vec3<double> tip = Vec3<double>::Zero();
  for (const Frame& frame : model.frames)
    if (frame.joint == joint && frame.placement.p.norm() > tip.norm()) tip = frame.placement.p;
  return tip.norm() < centre.norm() ? Vec3<double>(2 * centre) : tip;
}

// Adds capsules for bodies without a complete shape, from a body's joint to its child joints, or to the tip of a leaf.
// Body -1 is a fixed base.
void add_capsules(const Model& model, const std::vector<char>& whole, Json& shapes) {
  const double radius = std::max(0.03 * reach_of(model), 0.005);
  std::vector<std::vector<Vec3<double>>> ends(whole.size());  // one entry per body, the base first
  for (const Joint& joint : model.joints) ends[joint.parent + 1].push_back(joint.placement.p);
  for (std::size_t body = model.floating_base ? 1 : 0; body < ends.size(); ++body) {
    if (whole[body]) continue;
    const int joint = static_cast<int>(body) - 1;
    const bool leaf = ends[body].empty() && joint >= 0;
    if (leaf) ends[body].push_back(tip_of(model, joint));
    for (const Vec3<double>& end : ends[body]) {
      const double slim = end.norm() > 0 ? std::min(radius, end.norm() / 3) : radius;
      shapes.push_back(capsule(joint, end, leaf ? slim : std::max(slim, 0.3 * radius), leaf));
    }
  }
}

Json names_of_bodies(const Model& model) {
  std::vector<std::string> names(model.joints.size());
  for (std::size_t i = 0; i < names.size(); ++i) names[i] = model.joints[i].name;
  for (const Frame& frame : model.frames)
    if (frame.joint >= 0 && !frame.merged) names[frame.joint] = frame.name;
  return names;
}

Json model_of(const std::string& urdf, const Model& model, Meshes& meshes) {
  std::unordered_map<std::string, const Frame*> frames;
  for (const Frame& frame : model.frames) frames.emplace(frame.name, &frame);
  std::vector<char> drawn(model.joints.size() + 1), short_of(drawn.size());  // flags per body, base first
  Json shapes = Json::array();
  for (const Visual& visual : load_visuals(urdf)) {
    const auto found = frames.find(visual.link);
    if (found == frames.end()) continue;
    const Frame& frame = *found->second;
    const auto body = static_cast<std::size_t>(frame.joint + 1);
    Json shape = {{"body", frame.joint},
                  {"shape", kNames[static_cast<int>(visual.shape)]},
                  {"size", {visual.size[0], visual.size[1], visual.size[2]}},
                  {"at", json_of(frame.placement * visual.placement)}};
    if (visual.colour) shape["colour"] = *visual.colour;
    if (visual.shape == VisualShape::kMesh) {
      const int mesh = mesh_number(urdf, visual.mesh, meshes);
      if (mesh < 0) {
        short_of[body] = 1;
        continue;
      }
      shape["mesh"] = mesh;
    }
    drawn[body] = 1;
    shapes.push_back(std::move(shape));
  }
  for (std::size_t body = 0; body < drawn.size(); ++body)
    if (short_of[body]) drawn[body] = 0;
  add_capsules(model, drawn, shapes);
  return {{"name", model.name}, {"bodies", names_of_bodies(model)}, {"shapes", std::move(shapes)}};
}

}  // namespace

Json shapes_of(const SceneFile& file, std::vector<std::string>& notes, std::vector<std::string>& read) {
  Meshes meshes;
  Json models = Json::array(), robots = Json::array();
  for (const RobotGroup& group : file.robot_groups) {
    const auto first = static_cast<std::size_t>(group.first);
    models.push_back(model_of(group.urdf, *file.scene.robots[first].model, meshes));
    for (std::size_t k = first; k < first + static_cast<std::size_t>(group.count); ++k)
      robots.push_back({{"name", file.scene.robots[k].name},
                        {"model", models.size() - 1},
                        {"base", json_of(file.scene.robots[k].base)}});
  }
  for (const auto& [path, number] : meshes.index) read.push_back(path);
  if (!meshes.lost.empty())
    notes.push_back("capsules represent " + std::to_string(meshes.lost.size()) +
                    (meshes.lost.size() == 1 ? " mesh: " : " meshes: ") +
                    text::join({meshes.lost.begin(), meshes.lost.end()}, 2));
  return {{"models", std::move(models)}, {"robots", std::move(robots)}, {"meshes", std::move(meshes.list)}};
}

}  // namespace manycontact::cli
