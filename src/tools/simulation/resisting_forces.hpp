#pragma once
// Workspace for the end of a semi-implicit Euler step.

#include <optional>

#include "manycontact/simulation/resisting_joints.hpp"
#include "momentum_steps.hpp"
#include "resisting_springs.hpp"

namespace manycontact {

namespace internal {

/// Workspace of bounded_energy.cpp. The energies [J] of a cluster (robots coupled by springs and contacts) are stored
/// at its first robot.
struct BoundedEnergy {
  Eigen::ArrayX2d account;  // columns: energy springs may still give, its maximum; kept between steps; NaN: unknown
  std::vector<int> cluster;
  Eigen::VectorXd before, without;    // energy of bodies: at the start; after a step without springs, minus other work
  Eigen::VectorXd given, most;        // energy that springs gave in this step; the largest they contain after the next
  Eigen::VectorXd fast_given;         // energy that springs faster than the step gave
  Eigen::VectorXd kinetic, relative;  // kinetic energy at the step's end; its part relative to the rigid motions
  std::vector<OneBody> bodies;        // one entry per free cluster
  struct Stretched {
    Eigen::VectorXd all, fast;
  } at_start, at_end;              // energies of all springs, and of springs faster than the step
  Eigen::VectorXd share, rigid_v;  // factor on velocities relative to the rigid motion; rigid-motion velocities (nv)

  std::vector<char> tied;           // one entry per cluster: whether it is fixed to the world
  std::vector<int> of_group;        // one entry per free group: its cluster
  std::vector<int> members, first;  // free groups sorted by cluster; start of each cluster in members
};

/// The equations that semi-implicit Euler solves: those of the scene with zero velocity, and with the inertias that
/// joint springs, dampers, PD laws and friction add to M.
struct AtRest {
  Scene& scene;
  SceneData& data;  // data of `scene`: SimulationData::dynamics if joints add nothing to M
};
AtRest at_rest_with_joints(SimulationData& data);

/// Adds the forces of PD laws at the start of the step to data.w, and the terms of joint forces at its end to M.
/// Updates the scene at rest to `scene` and the active contacts. Must be called before the solves of a step.
void take_joints(const Scene& scene, SimulationData& data);
/// Computes data.pd_torque, and the work of joint forces in data.work. Must be called after the solves of a step.
void account_for_joints(const Scene& scene, SimulationData& data, const Eigen::VectorXd& v_next);

}  // namespace internal

struct ResistingForces {
  explicit ResistingForces(const Scene& scene) : joints(scene) {
    if (!scene.springs.empty()) springs.emplace(scene);
  }
  internal::ResistingJoints joints;
  bool made = false;                     // whether the members at_rest and dynamics were created
  std::unique_ptr<SceneAtRest> at_rest;  // the scene with added inertias; null if SimulationData::at_rest is used
  std::unique_ptr<SceneData> dynamics;   // data of at_rest
  std::optional<internal::ResistingSprings> springs;  // empty if there are no springs between points
  internal::BoundedEnergy bounded;
};

}  // namespace manycontact
