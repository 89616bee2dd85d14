#include "describe.hpp"

#include <algorithm>
#include <filesystem>

#include "lines.hpp"

namespace manycontact::cli {

namespace {

constexpr std::size_t kMostRobotLines = 24;  // most lines about robots; with more groups, equal ones share lines

// Returns a text such as ", wrenches: 2, springs: 3", or "" if the scene has neither.
std::string applied_forces(const Scene& scene) {
  const std::size_t springs = scene.springs.size() + scene.joint_springs.size();
  std::string out;
  if (!scene.wrenches.empty()) out += ", wrenches: " + std::to_string(scene.wrenches.size());
  if (springs > 0) out += ", springs: " + std::to_string(springs);
  return out;
}

}  // namespace

std::string group_name(const RobotGroup& group) {
  return group.copied ? group.name + " x" + std::to_string(group.count) : group.name;
}

std::string joint_types(const Model& model) {
  const std::pair<JointType, const char*> types[] = {{JointType::kFloating, "floating"},
                                                     {JointType::kPlanar, "planar"},
                                                     {JointType::kRevolute, "revolute"},
                                                     {JointType::kPrismatic, "prismatic"}};
  std::vector<std::string> parts;
  for (const auto& [type, name] : types) {
    const auto n = std::ranges::count(model.joints, type, &Joint::type);
    if (n > 0) parts.push_back(std::to_string(n) + " " + name);
  }
  return parts.empty() ? "none" : join(parts);
}

std::string robot_names(const SceneFile& file, const std::vector<int>& robots) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < robots.size();) {
    const RobotGroup& group = file.robot_groups[file.robot_group[robots[i]]];
    std::size_t end = i;
    while (end < robots.size() && robots[end] < group.first + group.count) ++end;
    if (static_cast<int>(end - i) == group.count)
      names.push_back(group_name(group));
    else
      for (std::size_t k = i; k < end; ++k) names.push_back(file.scene.robots[robots[k]].name);
    i = end;
  }
  return join(names, 4);
}

std::string islands_name(const SceneFile& file, const std::vector<const Island*>& islands) {
  std::vector<std::string> names;
  for (const Island* island : islands) names.push_back(robot_names(file, island->robots));
  if (names.size() > 3) return names.front() + " .. " + names.back();
  return join(names, 3, " | ");
}

std::vector<int> group_of_contacts(const SceneFile& file) {
  std::vector<int> group(file.scene.contacts.size());
  for (std::size_t g = 0; g < file.contact_groups.size(); ++g)
    for (int k = 0; k < file.contact_groups[g].count; ++k)
      group[file.contact_groups[g].first + k] = static_cast<int>(g);
  return group;
}

std::size_t count_islands(const Scene& scene, const SceneData& data) {
  const bool whole = data.options.method == Method::kDenseSchur;
  return whole ? find_islands(scene, data.active).size() : island_count(data);
}

void print_heading(std::ostream& out, const SceneFile& file, const SceneData& data) {
  const Scene& scene = file.scene;
  wrap(out, "Scene " + scene.name + " (" + file.path + ")", 0);
  const Vec3<double>& g = scene.gravity;
  wrap(out,
       "gravity " + number(g[0], 6) + " " + number(g[1], 6) + " " + number(g[2], 6) + " m/s^2, damping " +
           number(scene.damping) + ", " + count(scene.nv, "velocity") + ", " + count(data.f.size(), "contact row") +
           " in " + count(count_islands(scene, data), "island") + applied_forces(scene),
       0);
  Lines lines;  // copies share one line; so do neighbouring groups with equal cells if there are many groups
  const bool many = file.robot_groups.size() > kMostRobotLines;
  for (const RobotGroup& group : file.robot_groups) {
    const Model& model = *scene.robots[group.first].model;
    add_line(lines, many ? 0 : group.first, group_name(group),
             {std::filesystem::path(group.urdf).filename().string(), model.floating_base ? "floating" : "fixed",
              std::to_string(model.nv), number(model.mass(), 4), joint_types(model)});
  }
  out << "\n";
  print_lines(out, Table("robot<24|urdf<24|base<|velocities|mass [kg]|joints<"), lines, kMostRobotLines, false);
}

void print_notes(std::ostream& out, const SceneFile& file) {
  // Text of the note, and names of the robots that it applies to.
  std::vector<std::pair<std::string, std::vector<std::string>>> notes;
  for (const RobotGroup& group : file.robot_groups) {
    const ModelNotes& n = file.scene.robots[group.first].model->notes;
    const auto note = [&](const std::vector<std::string>& joints, const std::string& what) {
      if (joints.empty()) return;
      const std::string text = what + ": " + join(joints);
      const auto same = std::ranges::find_if(notes, [&](const auto& said) { return said.first == text; });
      if (same == notes.end())
        notes.emplace_back(text, std::vector<std::string>{group_name(group)});
      else
        same->second.push_back(group_name(group));
    };
    note(n.merged, count(n.merged.size(), "fixed joint") + " merged into the parent's body");
    note(n.locked, count(n.locked.size(), "joint") + " locked");
  }
  for (const auto& [text, robots] : notes) wrap(out, text, 2, join(robots, 4) + ": ");
}

}  // namespace manycontact::cli
