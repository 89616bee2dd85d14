#pragma once
// ExternalWrenches and springs in solves and derivatives. To K x = b they are torques: nothing of K changes, and b =
// [tau - h;
// ..] is linear in them. So derivatives and products are those by q, v and torques on all coordinates, which every
// system has, joined with the torques' own:
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

  bool act = false;              // they act in the current solution: its scene has them
  std::vector<Vec6<double>> w;   // wrenches solved with
  AppliedForces<double> forces;  // wrenches on bodies at the state solved at
  struct OfThread {              // scratch
    AppliedScratch scratch;
    Eigen::VectorXd l, wq, wv, ww;  // vectors of the scene
  };
  std::vector<OfThread> threads;
};

namespace internal {

/// Whether wrenches or springs act in the current solution.
bool forces_are_applied(const Workspace& w);
/// Throws std::invalid_argument, in the name of `function`, unless data.wrenches has a wrench per push of the scene.
void check_pushes(const Scene& scene, const SceneData& data, const char* function);
/// tau += their torques, at q, v. tau: nv.
void add_applied_forces(const Scene& scene, SceneData& data, const double* q, const double* v, double* tau);
/// Whether a spring on the island's robots has no direction.
bool lacks_direction(const Scene& scene, const Workspace& w, const Island& island);

/// The request that `differentiate` uses where forces are applied: with respect to torques on all coordinates.
DerivativeRequest by_all_torques(DerivativeRequest request);
/// Combines the derivatives of that request with those of the torques, and keeps those that the user requested.
void join_applied_forces(const Scene& scene, SceneData& data, const DerivativeRequest& request);

/// Adds the terms of applied forces to right-hand sides without them: to R.X, and J_F^T to R.W. Right-hand sides are in
/// the island's order, and R is laid out.
void add_applied_right_hand_sides(const Scene& scene, SceneData& data, const Island& island, IslandDerivatives& R);
/// Sizes of the terms of applied torques and of their derivatives, at the current solution; zero where no forces act.
AppliedSizes applied_sizes(const Scene& scene, const SceneData& data, const Island& island);

}  // namespace internal
}  // namespace manycontact
