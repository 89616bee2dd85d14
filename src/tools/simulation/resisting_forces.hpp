#pragma once
// Memory of what a semi-implicit Euler step takes at its end.

#include <optional>

#include "manycontact/simulation/resisting_joints.hpp"
#include "resisting_springs.hpp"

namespace manycontact {

namespace internal {

/// Memory of bound_energy, per robot. Energies are of the clusters of robots that springs and contacts join, at their
/// first.
struct BoundedEnergy {
  std::vector<int> cluster;
  std::vector<char> sprung, tied;                       // a spring acts on the cluster; the world constrains it
  std::vector<char> far;                                // it turns by angles that are large for its springs
  std::vector<double> turn;                             // of a robot's joints, the farthest [rad]
  Eigen::VectorXd before, after, least, size, kinetic;  // J; before: with what was given in the step
  Eigen::VectorXd share;                                // of the motion relative to that as one body
  Eigen::VectorXd mean, unbounded_v, rigid_v;           // nv
  std::vector<double> none;

  std::vector<PartOfBody> parts;    // per free group
  std::vector<int> of_group;        // per free group: its cluster
  std::vector<int> members, first;  // free groups, cluster by cluster; per cluster where they begin
  std::vector<OneBody> bodies;      // per cluster
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
