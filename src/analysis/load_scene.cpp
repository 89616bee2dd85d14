#include "manycontact/analysis/load_scene.hpp"

#include "manycontact/dynamics/quasi_static.hpp"

namespace manycontact {

SceneFile load_scene(const std::string& path) {
  SceneFile file = read_scene(path);
  if (file.gravity_robots.empty()) return file;
  const Eigen::VectorXd u = quasi_static(file.scene, file.q);
  for (const int r : file.gravity_robots) {
    const Robot& robot = file.scene.robots[r];
    file.u.segment(robot.idx_u, robot.model->nu()) = u.segment(robot.idx_u, robot.model->nu());
  }
  return file;
}

}  // namespace manycontact
