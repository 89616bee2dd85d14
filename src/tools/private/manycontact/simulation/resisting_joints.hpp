#pragma once
// Forces of joints that resist motion, evaluated at the end of a semi-implicit Euler step of any length.
//
// A joint's damper d, spring k and PD law add -(d + h k) v+ to their force at the start of the step: the diagonal of M
// gets h d + h^2 k, like a rotor's inertia. A spring does not resist a share of the start velocity (spring_share.hpp),
// computed with 1/m from M^-1 at q = 0, independent of the state. Coulomb friction with limit F is the multiplier of
// v+ = 0 while it is below h F. A sticking joint gets the inertia h F / kStickVelocity, a sliding joint the force F.
// Newton's method finds which joints stick. With K = M plus these inertias and v0 = K^-1 b, it minimises
//
//     min  1/2 (v - v0)^T K (v - v0) + h F sum of huber(v),        huber' = clamp(v / kStickVelocity, -1, 1)
//
// with an exact line search. The function is convex and piecewise quadratic, so that finitely many solves suffice. One
// solve suffices if every joint sticks or slides as in the last step.

#include "manycontact/simulation/step.hpp"

namespace manycontact::internal {

/// Most solves of a step in which Newton's method finds the sticking joints.
constexpr int kMostSolves = 50;
/// A joint sticks below this speed [rad/s, m/s].
constexpr double kStickVelocity = 1e-6;

struct ResistingJoints {
  explicit ResistingJoints(const Scene& scene);

  // These members have one entry per velocity coordinate.
  Eigen::VectorXd damping;        // N m s / rad
  Eigen::VectorXd friction;       // N m
  std::vector<signed char> slip;  // 0: sticks; 1, -1: slides in the positive, negative direction
  Eigen::VectorXd added, to_add;  // h d + h^2 k of the last factorization, and of this step
  Eigen::VectorXd mobility;       // 1/m of joints with springs [1/kg, 1/(kg m^2)]; 0 at other coordinates
  Eigen::VectorXd kept, kept_k;   // joint springs: share of v that they do not resist; that share times h^2 k
  std::vector<int> rubbing;       // coordinates with friction

  bool vary = false;                           // added inertias may change: robots then do not share models
  std::vector<std::shared_ptr<Model>> models;  // models with added inertias; null: the scene's, or another robot's

  // Newton's method, per entry of `rubbing`: v and K (v - v0) before and after a solve.
  bool begun = false;
  Eigen::VectorXd speed, force, next_speed, next_force;
  std::vector<int> island, order;  // islands, each with one line search; entries of `rubbing` sorted by island

  /// Computes to_add for steps of size h.
  void find(const Scene& scene, const PdLaws& pd, double h);
  /// Returns the scene with to_add in its armatures, and without dampers and friction.
  Scene with_inertias(const Scene& scene);
  /// Whether the scene made by with_inertias is valid for to_add. If not, with_inertias must be called again.
  bool fits(const Scene& scene) const;

  /// Sets the inertias of joints that stick, before each solve.
  void set_inertias(const Scene& scene, double h);
  /// The inertia that is added to a coordinate.
  double inertia(int i, double h) const {
    return added[i] + (friction[i] > 0 && slip[i] == 0 ? h * friction[i] / kStickVelocity : 0);
  }
  /// The part of inertia(i, h) that resists v.
  double drag(int i, double h) const { return inertia(i, h) - kept_k[i]; }
  /// Subtracts scale times the friction force of sliding joints from b (nv).
  void add_sliding(double scale, Eigen::VectorXd& b) const {
    for (const int i : rubbing) b[i] -= scale * slip[i] * friction[i];
  }
  /// Whether `slip` agrees with v+ (nv); if not, updates `slip` for the next solve. islands: prepared data of `scene`.
  [[nodiscard]] bool settles(const Scene& scene, const SceneData& islands, double h, const Eigen::VectorXd& v_next);
};

/// k (nv) += scale times the stiffness of springs and PD laws of joints.
void add_stiffness(const Scene& scene, const PdLaws& pd, double scale, Eigen::VectorXd& k);
/// tau (nv) += kp (q_ref - q) + kd (v_ref - v).
void add_pd_torques(const Scene& scene, const PdLaws& pd, const Eigen::VectorXd& q, const Eigen::VectorXd& v,
                    Eigen::VectorXd& tau);
/// Throws std::invalid_argument unless data.pd fits the scene.
void check_pd(const Scene& scene, const PdLaws& pd);

}  // namespace manycontact::internal
