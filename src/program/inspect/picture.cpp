// Writes the numbers from which charts/pattern.py draws the patterns of K and L for `inspect --picture`.

#include <map>

#include "../files/json_file.hpp"
#include "../files/output_file.hpp"
#include "../files/python.hpp"
#include "../text/places.hpp"
#include "inspect.hpp"
#include "manycontact/dynamics/shapes.hpp"

namespace manycontact::cli {

namespace {

// Returns the entries of K's upper triangle and of L without its diagonal, by columns, in the order of elimination.
Json pattern_of(const KktPattern& p) {
  return {{"nv", p.nv},
          {"perm", p.perm},
          {"K", {{"begin", p.K.p}, {"rows", p.K.i}}},
          {"L", {{"begin", p.ldl.Lp}, {"rows", p.ldl.Li}}}};
}

// Returns the scene's indices of the rows of an island's K: velocities of the robots, then rows of active contacts.
std::vector<int> rows_in_scene(const Scene& scene, const SceneData& data, const Island& island) {
  Places places(scene, data.f_offset, island);
  for (const int f : places.f) places.v.push_back(scene.nv + f);
  return places.v;
}

// Adds all islands to the JSON for the picture, and once each pattern that islands share.
void add_islands(const Inspection& x, Json& to) {
  const SceneData& solved = data_solved(x.data);
  std::map<const KktPattern*, std::size_t> numbers;
  to["patterns"] = to["islands"] = Json::array();
  for (std::size_t i = 0; i < island_count(x.data); ++i) {
    const auto [at, fresh] = numbers.emplace(&x.pattern(i), numbers.size());
    if (fresh) to["patterns"].push_back(pattern_of(x.pattern(i)));
    to["islands"].push_back(
        {{"pattern", at->second},
         {"rows", rows_in_scene(scene_solved(x.file.scene, x.data), solved, solved_island(solved, i))},
         {"order", to_string(chosen_method(x.data, i).order)}});
  }
}

Json robots(const Inspection& x) {
  Json out = Json::array();
  for (const RobotGroup& group : x.file.robot_groups) {
    const Robot& robot = x.file.scene.robots[group.first];
    std::vector<std::string> names;
    for (int k = 0; k < group.count; ++k) names.push_back(x.file.scene.robots[group.first + k].name);
    out.push_back({{"name", group_name(group)}, {"names", names}, {"first", robot.idx_v}, {"nv", robot.model->nv}});
  }
  return out;
}

// Returns name, first row and number of rows of the active contacts of each <contact> element.
Json contacts(const Inspection& x) {
  Json out = Json::array();
  for (const ContactGroup& group : x.file.contact_groups) {
    int first = -1, size = 0;
    for (int c = group.first; c < group.first + group.count; ++c) {
      if (x.data.f_offset[c] < 0) continue;
      if (first < 0) first = x.file.scene.nv + x.data.f_offset[c];
      size += x.file.scene.contacts[c].rows();
    }
    const bool copies = group.copied && group.count > 1;
    if (size > 0) out.push_back({group.name + (copies ? " x" + std::to_string(group.count) : ""), first, size});
  }
  return out;
}

}  // namespace

void write_picture(const Inspection& x, const Python& python, const std::string& path) {
  const Scene& scene = x.file.scene;
  Json json = {{"name", scene.name},
               {"nv", scene.nv},
               {"nc", data_solved(x.data).f.size()},
               {"rows", x.data.f.size()},
               {"damping", scene.damping > 0},
               {"robots", robots(x)},
               {"contacts", contacts(x)}};
  add_islands(x, json);
  OutputFile svg(path, "--picture");
  svg.stream() << run_python(python, script_path("pattern.py"), {},
                             json.dump(-1, ' ', false, Json::error_handler_t::replace));
  svg.close();
}

}  // namespace manycontact::cli
