#include "manycontact/analysis/load_scene.hpp"

#include <algorithm>

#include "manycontact/analysis/consistent.hpp"
#include "manycontact/analysis/findings.hpp"
#include "manycontact/analysis/place.hpp"
#include "manycontact/dynamics/quasi_static.hpp"
#include "manycontact/io/task_file.hpp"

namespace manycontact {

void fit_state(SceneFile& file) {
  place(file);
  make_consistent(file);
}

void fit_state(TaskFile& task) {
  fit_state(task.scene);
  place_references(task);
}

namespace {

SceneFile completed(SceneFile file) {
  fit_state(file);
  if (file.gravity_robots.empty()) return file;
  std::vector<Unbalanced> unbalanced;
  const Eigen::VectorXd u = quasi_static(file.scene, file.q, &unbalanced);
  for (const int r : file.gravity_robots) {
    const Robot& robot = file.scene.robots[r];
    file.u.segment(robot.idx_u, robot.model->nu()) = u.segment(robot.idx_u, robot.model->nu());
  }
  for (const Unbalanced& x : unbalanced)
    if (std::ranges::binary_search(file.gravity_robots, x.robot))
      file.findings.push_back(
          {"rest", name_of(file.scene, x), in_words(x), file.path, file.robot_groups[file.robot_group[x.robot]].line});
  return file;
}

}  // namespace

SceneFile load_scene(const std::string& path) { return completed(read_scene(path)); }

SceneFile load_scene_text(const std::string& text, const std::string& path) {
  return completed(read_scene_text(text, path));
}

}  // namespace manycontact
