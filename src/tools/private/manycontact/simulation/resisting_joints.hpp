#pragma once
// Forces of joints that resist motion, evaluated at the end of a semi-implicit Euler step of any length.
//
// A joint's damper d, spring k and PD law add -(d + h k) v+ to their force at the start of the step. This adds h d +
// h^2 k to the diagonal of M, like a rotor's inertia. A spring does not resist a share of the start velocity
// (spring_share.hpp). The share is computed with M^-1 at q = 0, so that it is independent of the state. Coulomb
// friction with limit F is the multiplier of v+ = 0 while it is below h F. A sticking joint gets the inertia h F /
// kStickVelocity, a sliding joint the force F. Newton's method finds which joints stick. With K = M plus these inertias
// and v0 = K^-1 b, it minimises
//
//     min  1/2 (v - v0)^T K (v - v0) + h F sum of huber(v),        huber' = clamp(v / kStickVelocity, -1, 1)
//
// with an exact line search. The function is convex and piecewise quadratic, so that finitely many solves suffice. One
// solve suffices if every joint sticks or slides as in the last step.

#include "manycontact/simulation/step.hpp"

namespace manycontact::internal {

constexpr int kMostSolves = 50;          // most solves per step in which Newton's method finds the sticking joints
constexpr double kStickVelocity = 1e-6;  // a joint sticks below this speed [rad/s, m/s]

struct ResistingJoints {
  explicit ResistingJoints(const Scene& scene);

  // These members have one entry per velocity coordinate.
  Eigen::VectorXd damping;        // d of the joint's damper [N m s / rad, N s / m]
  Eigen::VectorXd friction;       // limit F of Coulomb friction [N m, N]
  std::vector<signed char> slip;  // 0: the joint sticks; 1 or -1: it slides in the positive or negative direction
  Eigen::VectorXd added, to_add;  // h d + h^2 k of the last factorization, and of this step
  Eigen::VectorXd mobility;       // joints with springs: 1/m, m the mass or inertia that moves; other coordinates: 0
  Eigen::VectorXd kept, kept_k;   // kept: share of v that joint springs do not resist; kept_k: h^2 k times this share
  std::vector<int> rubbing;       // coordinates with friction

  bool vary = false;                           // whether added inertias may change; then robots do not share models
  std::vector<std::shared_ptr<Model>> models;  // models with added inertias; null: the scene's, or another robot's

  bool begun = false;  // whether Newton's method has begun in this step, so that speed and force are set
  Eigen::VectorXd speed, force, next_speed, next_force;  // v, K (v - v0) of `rubbing` joints; at the last solve
  std::vector<int> island, order;  // each joint's island, which has its own line search; `rubbing` sorted by island

  void find(const Scene& scene, const PdLaws& pd, double h);  // computes to_add for steps of size h
  /// Returns the scene with to_add in its armatures, without dampers and friction.
  Scene with_inertias(const Scene& scene);
  bool fits(const Scene& scene) const;  // whether the scene that with_inertias made still fits to_add

  void set_inertias(const Scene& scene, double h);  // sets the inertias of `models`; call it before each solve
  double inertia(int i, double h) const {           // inertia added to M at coordinate i
    return added[i] + (friction[i] > 0 && slip[i] == 0 ? h * friction[i] / kStickVelocity : 0);
  }
  double drag(int i, double h) const { return inertia(i, h) - kept_k[i]; }  // inertia that resists v
  /// Subtracts scale times the friction force of sliding joints from b (nv).
  void add_sliding(double scale, Eigen::VectorXd& b) const {
    for (const int i : rubbing) b[i] -= scale * slip[i] * friction[i];
  }
  /// Returns whether `slip` agrees with v+ (nv). If not, updates `slip` for the next solve. islands: prepared data.
  [[nodiscard]] bool settles(const Scene& scene, const SceneData& islands, double h, const Eigen::VectorXd& v_next);
};

/// Adds `scale` times the stiffness of springs and PD laws of joints to k (nv).
void add_stiffness(const Scene& scene, const PdLaws& pd, double scale, Eigen::VectorXd& k);
/// Adds the torques kp (q_ref - q) + kd (v_ref - v) of the PD laws to tau (nv).
void add_pd_torques(const Scene& scene, const PdLaws& pd, const Eigen::VectorXd& q, const Eigen::VectorXd& v,
                    Eigen::VectorXd& tau);
void check_pd(const Scene& scene, const PdLaws& pd);  // throws std::invalid_argument unless data.pd fits the scene

}  // namespace manycontact::internal
