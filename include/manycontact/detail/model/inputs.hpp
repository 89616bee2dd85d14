#pragma once
// The initial inputs of solve that a scene defines: torques of all coordinates, flags of contacts, and external
// wrenches. Further functions copy external wrenches and springs to scenes that are composed of robots of other scenes.

#include "manycontact/model/scene.hpp"

namespace manycontact {

/// Sets tau (nv) [N m, N] to the torques u (nu): zero for coordinates without an actuator.
inline void torques_of_motors(const Scene& scene, const ConstVectorRef& u, Eigen::VectorXd& tau) {
  tau.setZero();
  for (const Robot& robot : scene.robots)
    for (int k = 0; k < robot.model->nu(); ++k) tau[robot.idx_v + robot.model->actuated[k]] = u[robot.idx_u + k];
}

/// Returns one flag per contact: whether it is active in the scene.
inline std::vector<char> active_contacts(const Scene& scene) {
  std::vector<char> active;
  for (const Contact& contact : scene.contacts) active.push_back(contact.active);
  return active;
}

/// Returns the external wrenches of the scene.
inline std::vector<Vec6<double>> external_wrenches(const Scene& scene) {
  std::vector<Vec6<double>> wrenches;
  for (const ExternalWrench& wrench : scene.wrenches) wrenches.push_back(wrench.wrench);
  return wrenches;
}

/// Removes external wrenches and springs, so that only gravity, motors and contacts act on the scene.
void drop_applied_forces(Scene& scene);

/// Adds to `to` the external wrenches and springs of `from` whose robots are in `to`, even if names repeat. robot_at:
/// for each robot of `from` its number in `to`, or -1.
void take_applied_forces(const Scene& from, const std::vector<int>& robot_at, Scene& to);

}  // namespace manycontact
