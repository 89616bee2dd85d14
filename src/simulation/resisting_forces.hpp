#pragma once
// Memory of what a semi-implicit Euler step takes at its end.

#include <optional>

#include "resisting_joints.hpp"
#include "resisting_springs.hpp"

namespace manycontact {

namespace internal {

/// Memory of bound_energy, per robot; energies are of the clusters of robots that springs and contacts join, at their
/// first.
struct BoundedEnergy {
  std::vector<int> cluster;
  std::vector<char> sprung;             // a spring acts on the cluster
  Eigen::VectorXd before, after, size;  // J; before: with what was given in the step
  Eigen::VectorXd share;                // of v+ that is left
  Eigen::VectorXd mean, unbounded_v;    // nv
};

}  // namespace internal

struct ResistingForces {
  explicit ResistingForces(const Scene& scene) : joints(scene) {
    if (!scene.springs.empty()) springs.emplace(scene);
  }
  internal::ResistingJoints joints;
  std::optional<internal::ResistingSprings> springs;  // nullopt: there are none between points
  internal::BoundedEnergy bounded;
  Eigen::VectorXd b;                                  // nv: right-hand side
};

}  // namespace manycontact
