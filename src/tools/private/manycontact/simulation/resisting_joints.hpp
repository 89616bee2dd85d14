#pragma once
// Forces of joints that resist motion, taken at the end of a semi-implicit Euler step of any length.
//
// The damper d, the spring k and the PD law of a joint act by -(d + h k) v+ in addition to their start values, so M
// gets h d + h^2 k on its diagonal, as of a rotor's inertia. A spring gets its share of h k v back (spring_share.hpp),
// with 1/m of M^-1 where the joints are 0: the share is a number of the scene, not of its state. Coulomb's friction is
// the multiplier of v+ = 0 while that is below h F. A joint that sticks gets the inertia h F / kStickVelocity, one that
// slides the constant force. Which does what is found by Newton's method on
//
//     min  1/2 (v - v0)^T K (v - v0) + h F sum of huber(v),        huber' = clamp(v / kStickVelocity, -1, 1)
//
// with an exact line search: the function is convex and piecewise quadratic, so that finitely many solves end it. Where
// every joint does what it did in the step before, one solve does.

#include "manycontact/simulation/step.hpp"

namespace manycontact::internal {

/// Solves of a step at most, until friction settles.
constexpr int kMostSolves = 50;
/// A joint sticks below this speed [rad/s, m/s].
constexpr double kStickVelocity = 1e-6;

struct ResistingJoints {
  explicit ResistingJoints(const Scene& scene);

  // These members have one entry per velocity coordinate.
  Eigen::VectorXd damping;        // N m s / rad
  Eigen::VectorXd friction;       // N m
  std::vector<signed char> slip;  // 0: sticks; 1, -1: slides that way
  Eigen::VectorXd added, to_add;  // h d + h^2 k: the values of the last factorization, and of this step
  Eigen::VectorXd mobility;       // 1/m of joints with springs [1/kg, 1/(kg m^2)]; 0 at other coordinates
  Eigen::VectorXd kept, kept_k;   // joint springs: the share of v that they do not resist; this share of h^2 k
  std::vector<int> rubbing;       // the coordinates with friction

  bool vary = false;                           // added inertias may change: equal robots have separate models
  std::vector<std::shared_ptr<Model>> models;  // models with added inertias; null: the scene's, or shared

  // Newton's method, per entry of `rubbing`: v and K (v - v0) before and after a solve.
  bool begun = false;
  Eigen::VectorXd speed, force, next_speed, next_force;
  std::vector<int> island, order;  // islands, each with one line search; entries of `rubbing` sorted by island

  /// Computes to_add for steps of size h.
  void find(const Scene& scene, const PdLaws& pd, double h);
  /// Returns the scene with to_add in its armatures, and without dampers and friction.
  Scene with_inertias(const Scene& scene);
  /// Whether that scene is valid for to_add. Otherwise another one must be made.
  bool fits(const Scene& scene) const;

  /// Before each solve: of joints that stick, the inertia; of `scene`.
  void set_inertias(const Scene& scene, double h);
  /// The inertia added to a coordinate then.
  double inertia(int i, double h) const {
    return added[i] + (friction[i] > 0 && slip[i] == 0 ? h * friction[i] / kStickVelocity : 0);
  }
  /// The inertia that resists v, too.
  double drag(int i, double h) const { return inertia(i, h) - kept_k[i]; }
  /// b -= scale F of joints that slide.
  void add_sliding(double scale, Eigen::VectorXd& b) const {
    for (const int i : rubbing) b[i] -= scale * slip[i] * friction[i];
  }
  /// After it: whether v+ (nv) is as joints slide or stick. If not, they do otherwise at the next solve. islands: of
  /// `scene`, prepared.
  [[nodiscard]] bool settles(const Scene& scene, const SceneData& islands, double h, const Eigen::VectorXd& v_next);
};

/// scale times the stiffness of springs and PD laws of joints added to k (nv).
void add_stiffness(const Scene& scene, const PdLaws& pd, double scale, Eigen::VectorXd& k);
/// kp (q_ref - q) + kd (v_ref - v) added to tau (nv).
void add_pd_torques(const Scene& scene, const PdLaws& pd, const Eigen::VectorXd& q, const Eigen::VectorXd& v,
                    Eigen::VectorXd& tau);
/// Throws std::invalid_argument unless data.pd fits the scene.
void check_pd(const Scene& scene, const PdLaws& pd);

}  // namespace manycontact::internal
