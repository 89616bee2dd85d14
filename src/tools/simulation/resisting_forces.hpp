#pragma once
// Workspace of the end of a semi-implicit Euler step.

#include <optional>

#include "manycontact/simulation/resisting_joints.hpp"
#include "momentum_steps.hpp"
#include "resisting_springs.hpp"

namespace manycontact {

namespace internal {

/// Workspace of bounded_energy.cpp. Springs and contacts couple robots into clusters. The entry of a cluster's first
/// robot is the energy of the cluster [J].
struct BoundedEnergy {
  // Kept from step to step: energy that springs may still give, and the most that it has been. NaN where it must be
  // computed.
  Eigen::ArrayX2d account;
  std::vector<int> cluster;
  // Energy of the bodies at the start, and after the step without springs, less what others gave.
  Eigen::VectorXd before, without;
  Eigen::VectorXd given, most;        // what springs gave in this step; the most that they can hold
  Eigen::VectorXd fast_given;         // what springs faster than the step gave
  Eigen::VectorXd kinetic, relative;  // kinetic energy at the end; that relative to the clusters' motion as one body
  std::vector<OneBody> bodies;        // one entry per cluster that is free
  struct Stretched {
    Eigen::VectorXd all, fast;
  } at_start, at_end;              // energies of springs
  Eigen::VectorXd share, rigid_v;  // left of the motion relative to that of the clusters as one body, and that (nv)

  std::vector<char> tied;           // one entry per cluster: it is fixed to the world
  std::vector<int> of_group;        // one entry per free group: its cluster
  std::vector<int> members, first;  // free groups sorted by cluster; first: where each cluster begins in members
};

/// The equations that semi-implicit Euler solves: the scene at rest, with the joints' additions to M.
struct AtRest {
  Scene& scene;
  SceneData& data;  // data.dynamics if joints add nothing
};
AtRest at_rest_with_joints(SimulationData& data);

/// Call it before a step's solves. Adds the forces of PD laws at the start of the step to data.w, and to M the terms of
/// all joint forces at its end. The scene at rest with these terms follows `scene` and the active contacts.
void take_joints(const Scene& scene, SimulationData& data);
/// After them: data.pd_torque and data.work of joints.
void account_for_joints(const Scene& scene, SimulationData& data, const Eigen::VectorXd& v_next);

}  // namespace internal

struct ResistingForces {
  explicit ResistingForces(const Scene& scene) : joints(scene) {
    if (!scene.springs.empty()) springs.emplace(scene);
  }
  internal::ResistingJoints joints;
  bool made = false;                     // whether at_rest and dynamics are made
  std::unique_ptr<SceneAtRest> at_rest;  // the scene with the joints' inertias; null: SimulationData::at_rest is used
  std::unique_ptr<SceneData> dynamics;   // data of that scene
  std::optional<internal::ResistingSprings> springs;  // nullopt: there are no springs between points
  internal::BoundedEnergy bounded;
};

}  // namespace manycontact
