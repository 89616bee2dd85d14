#pragma once
// External wrenches and springs in solves and derivatives. They are torques on the right of K x = b: K is unchanged,
// and b = [tau - h; ..] is linear in them. Derivatives by all torques are combined with those of tau(q, v, w):
//
//     d/dq  +=  d/dtau dtau/dq,     d/dv  +=  d/dtau dtau/dv,     d/dw  =  d/dtau J_F^T.

#include "manycontact/algorithm/applied_forces.hpp"
#include "manycontact/detail/kkt/island.hpp"
#include "manycontact/dynamics/derivatives.hpp"

namespace manycontact {

struct SceneData;
struct IslandWork;
struct Workspace;

/// External wrenches and springs that act in a scene, as of the last solve. Scenes without them do not allocate it.
struct AppliedWork {
  explicit AppliedWork(const Scene& scene);

  bool act = false;              // whether they act in the current solution
  std::vector<Vec6<double>> w;   // wrenches of the last solve
  AppliedForces<double> forces;  // wrenches on bodies at the state of the last solve
  struct OfThread {              // scratch
    AppliedScratch scratch;
    Eigen::VectorXd l, wq, wv, ww;  // vectors of the scene
  };
  std::vector<OfThread> threads;
};

namespace internal {

/// Whether wrenches or springs act in the current solution.
bool forces_are_applied(const Workspace& w);
/// Throws std::invalid_argument, naming `function`, unless data.wrenches has one entry per wrench of the scene.
void check_pushes(const Scene& scene, const SceneData& data, const char* function);
/// Adds the torques of wrenches and springs at q, v to tau (nv).
void add_applied_forces(const Scene& scene, SceneData& data, const double* q, const double* v, double* tau);
/// Whether a spring on the island's robots has no direction.
bool lacks_direction(const Scene& scene, const Workspace& w, const Island& island);

/// The request that `differentiate` uses where forces are applied: with respect to torques on all coordinates.
DerivativeRequest by_all_torques(DerivativeRequest request);
/// Combines the derivatives of by_all_torques(request) with those of the applied torques; keeps those of `request`.
void join_applied_forces(const Scene& scene, SceneData& data, const DerivativeRequest& request);

/// Adds the terms of applied forces to the right-hand sides R.X, and J_F^T to R.W; R is laid out.
void add_applied_right_hand_sides(const Scene& scene, SceneData& data, const Island& island, IslandDerivatives& R);
/// Returns magnitudes of applied torques and of their derivatives at the current solution; zero where no forces act.
AppliedSizes applied_sizes(const Scene& scene, const SceneData& data, const Island& island);

}  // namespace internal
}  // namespace manycontact
