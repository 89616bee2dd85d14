#pragma once
// Forces of joints that resist motion, taken at the end of a semi-implicit Euler step of any length.
//
// The damper d, the spring k and the PD law of a joint act by -(d + h k) v+ beside what they are at the start, so that
// M gets h d + h^2 k on its diagonal, as of a rotor's inertia. Coulomb's friction is the multiplier of v+ = 0 while that
// is below h F. A joint that sticks gets the inertia h F / kStickVelocity, one that slides the constant force. Which
// does what is found by Newton's method on
//
//     min  1/2 (v - v0)^T K (v - v0) + h F sum of huber(v),        huber' = clamp(v / kStickVelocity, -1, 1)
//
// with an exact line search: the function is convex and piecewise quadratic, so that finitely many solves end it. Where
// every joint does what it did in the step before, one solve does.

#include "manycontact/simulation/step.hpp"

namespace manycontact::internal {

/// A joint sticks below this speed [rad/s, m/s].
constexpr double kStickVelocity = 1e-6;

struct ResistingJoints {
  explicit ResistingJoints(const Scene& scene);

  // Per velocity coordinate.
  std::vector<int> place;         // of q, of joints of one coordinate; -1: of others
  Eigen::VectorXd damping;        // N m s / rad
  Eigen::VectorXd friction;       // N m
  std::vector<signed char> slip;  // 0: sticks; 1, -1: slides that way
  Eigen::VectorXd added, to_add;  // h d + h^2 k: as solved with, and in this step
  std::vector<int> rubbing;       // the coordinates with friction

  bool made = false, vary = false;
  std::vector<std::shared_ptr<Model>> models;  // per robot its own; nullptr: the scene's, or shared with other robots
  std::unique_ptr<SceneAtRest> at_rest;        // with the inertias added; nullptr: SimulationData::at_rest serves
  std::unique_ptr<SceneData> dynamics;         // of that

  // Newton's method, per entry of `rubbing`: v, K (v - v0), and the same after a solve.
  bool begun = false;
  Eigen::VectorXd speed, force, next_speed, next_force;
  std::vector<int> island, order;  // whose line search is one; entries island by island
};

/// What semi-implicit Euler solves: the scene at rest, with what joints add to M.
struct AtRest {
  const Scene& scene;
  SceneData& data;  // data.dynamics where they add nothing
};
AtRest at_rest_with_joints(const Scene& scene, SimulationData& data);

/// Before a step's solves: adds to data.w what joints' springs and PD laws do at its start but for
/// -k (q - q0), which is there, and to M what they add at its end.
void take_joints(const Scene& scene, SimulationData& data);
/// Before each solve: friction of joints that slide, into b, and the inertia of those that stick.
void begin_friction(const Scene& scene, SimulationData& data, Eigen::VectorXd& b);
/// After it: whether v+ is as its joints slide or stick. If not, they do otherwise at the next solve.
[[nodiscard]] bool friction_settles(const Scene& scene, SimulationData& data, const Eigen::VectorXd& v_next);
/// After the step's solves: data.pd_torque and data.work of joints.
void account_for_joints(const Scene& scene, SimulationData& data, const Eigen::VectorXd& v_next);

/// kp (q_ref - q) + kd (v_ref - v) added to tau (nv).
void add_pd_torques(const Scene& scene, const PdLaws& pd, const Eigen::VectorXd& q, const Eigen::VectorXd& v,
                    Eigen::VectorXd& tau);
/// Throws std::invalid_argument unless data.pd fits the scene.
void check_pd(const Scene& scene, const PdLaws& pd);

}  // namespace manycontact::internal
