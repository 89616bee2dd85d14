#pragma once
// External wrenches and springs in solves and derivatives. Their torques are part of tau in K x = [tau - h; ...], not
// of K. Derivatives with respect to torques on all coordinates are combined with derivatives of tau(q, v, w):
//
//     d/dq  +=  d/dtau dtau/dq,     d/dv  +=  d/dtau dtau/dv,     d/dw  =  d/dtau J_F^T,
//
// where J_F is the Jacobian of the frames on which the external wrenches w act.

#include "manycontact/algorithm/applied_forces.hpp"
#include "manycontact/detail/kkt/island.hpp"
#include "manycontact/dynamics/derivatives.hpp"

namespace manycontact {

struct SceneData;
struct IslandWork;
struct Workspace;

/// External wrenches and springs at the last solve; allocated only for scenes that have any.
struct AppliedWork {
  explicit AppliedWork(const Scene& scene);

  bool act = false;              // whether wrenches or springs act in the current solution
  std::vector<Vec6<double>> w;   // wrenches of the last solve
  AppliedForces<double> forces;  // wrenches on bodies at the state of the last solve
  struct OfThread {              // scratch
    AppliedScratch scratch;
    Eigen::VectorXd l, wq, wv, ww;  // l, wq, wv: nv entries; ww: 6 per wrench
  };
  std::vector<OfThread> threads;
};

namespace internal {

bool forces_are_applied(const Workspace& w);  // whether wrenches or springs act in the current solution
/// Throws std::invalid_argument, naming `function`, unless data.wrenches has one entry per wrench of the scene.
void check_pushes(const Scene& scene, const SceneData& data, const char* function);
/// Adds the torques of wrenches and springs at q, v to tau (nv).
void add_applied_forces(const Scene& scene, SceneData& data, const double* q, const double* v, double* tau);
bool lacks_direction(const Scene& scene, const Workspace& w, const Island& island);  // whether a spring's ends coincide

DerivativeRequest by_all_torques(DerivativeRequest request);  // includes derivatives by torques on all coordinates
/// Adds derivatives of wrench and spring torques to those by_all_torques asked for; then keeps columns of `request`.
void join_applied_forces(const Scene& scene, SceneData& data, const DerivativeRequest& request);

/// Adds derivatives of wrench and spring torques to right-hand sides R.X (q, v) and R.W (wrenches), after lay_out.
void add_applied_right_hand_sides(const Scene& scene, SceneData& data, const Island& island, IslandDerivatives& R);
/// Returns magnitudes of the torques of wrenches and springs and of their derivatives, per coordinate of the scene.
AppliedSizes applied_sizes(const Scene& scene, const SceneData& data, const Island& island);

}  // namespace internal
}  // namespace manycontact
