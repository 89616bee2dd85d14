#pragma once
// Memory of what a semi-implicit Euler step takes at its end.

#include <optional>

#include "manycontact/simulation/resisting_joints.hpp"
#include "resisting_springs.hpp"

namespace manycontact {

namespace internal {

/// Memory of bounded_energy.cpp. Energies are of the clusters of robots that springs and contacts join, at their first
/// robot [J].
struct BoundedEnergy {
  Eigen::VectorXd stored;  // what springs may give, kept from step to step; NaN: to be found anew
  std::vector<int> cluster;
  Eigen::VectorXd kinetic, before, after, most;  // before: with what others gave; most: that springs can hold
  Eigen::VectorXd kinetic_before;  // at the start
  struct Stretched {
    Eigen::VectorXd all, fast, useful;
  } at_start, at_end;              // energies of springs
  Eigen::VectorXd share, rigid_v;  // left of the motion relative to that of the clusters as one body, and that (nv)

  std::vector<char> tied;           // per cluster: the world constrains it
  std::vector<int> of_group;        // per free group: its cluster
  std::vector<int> members, first;  // free groups, cluster by cluster; per cluster where they begin
};

/// The equations that semi-implicit Euler solves: the scene at rest, with the joints' additions to M.
struct AtRest {
  Scene& scene;
  SceneData& data;  // data.dynamics where they add nothing
};
AtRest at_rest_with_joints(SimulationData& data);

/// Before a step's solves: adds what PD laws do at its start to data.w, and to M what all joints add at its end. The
/// scene at rest with that follows `scene` and the contacts that are active.
void take_joints(const Scene& scene, SimulationData& data);
/// After them: data.pd_torque and data.work of joints.
void account_for_joints(const Scene& scene, SimulationData& data, const Eigen::VectorXd& v_next);

}  // namespace internal

struct ResistingForces {
  explicit ResistingForces(const Scene& scene) : joints(scene) {
    if (!scene.springs.empty()) springs.emplace(scene);
  }
  internal::ResistingJoints joints;
  bool made = false;                     // the next two are
  std::unique_ptr<SceneAtRest> at_rest;  // with the joints' inertias; nullptr: SimulationData::at_rest serves
  std::unique_ptr<SceneData> dynamics;   // of that
  std::optional<internal::ResistingSprings> springs;  // nullopt: there are none between points
  internal::BoundedEnergy bounded;
};

}  // namespace manycontact
