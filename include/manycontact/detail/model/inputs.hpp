#pragma once
// What solve takes: torques of all coordinates, flags of contacts and external wrenches, as a scene has them initially;
// and the external wrenches and springs of scenes that are made of other scenes.

#include "manycontact/model/scene.hpp"

namespace manycontact {

/// tau (nv) of u (nu): zero where nothing is actuated.
inline void torques_of_motors(const Scene& scene, const ConstVectorRef& u, Eigen::VectorXd& tau) {
  tau.setZero();
  for (const Robot& robot : scene.robots)
    for (int k = 0; k < robot.model->nu(); ++k) tau[robot.idx_v + robot.model->actuated[k]] = u[robot.idx_u + k];
}

/// One flag per contact of the scene, as it has them.
inline std::vector<char> active_contacts(const Scene& scene) {
  std::vector<char> active;
  for (const Contact& contact : scene.contacts) active.push_back(contact.active);
  return active;
}

/// The external wrenches of the scene.
inline std::vector<Vec6<double>> external_wrenches(const Scene& scene) {
  std::vector<Vec6<double>> wrenches;
  for (const ExternalWrench& push : scene.wrenches) wrenches.push_back(push.wrench);
  return wrenches;
}

/// Removes external wrenches and springs: the scene then moves by gravity, motors and contacts alone.
void drop_applied_forces(Scene& scene);

/// Adds those of `from` whose robots are in `to`, as they are. robot_at: per robot of `from` its number in `to`, -1: it
/// is not there. Their names may be there already.
void take_applied_forces(const Scene& from, const std::vector<int>& robot_at, Scene& to);

}  // namespace manycontact
