#pragma once
// What a careful reader asks of a scene and its answer, and what no status says: contacts that start out of place or
// with a velocity they do not allow, that pull, slip, tip or turn where a one-sided contact could not, that contradict
// each other and by how much; joints beyond their limits, joints that carry nothing.

#include <string>
#include <vector>

#include "manycontact/dynamics/data.hpp"

namespace manycontact {

/// Placement errors below this are how files round their numbers [m, rad].
constexpr double kPlacementError = 1e-6;

/// A contact whose frames A and B' do not stand where it holds them.
struct PlacementError {
  int contact = 0;
  double position = 0;  // m: |p_A - p_B'| along the rows held
  double angle = 0;     // rad: between A's and B's axes (6D), between their hinges' (5D); 0 for points
};

/// Of the contacts flagged `active`, those out of place at q (scene.nq) by kPlacementError or more.
std::vector<PlacementError> placement_errors(const Scene& scene, const std::vector<char>& active,
                                             const Eigen::Ref<const Eigen::VectorXd>& q);

/// "0.1 m and 0.02 rad", without what is negligible.
std::string in_words(const PlacementError& error);

/// Velocities below this are how files round their numbers [m/s, rad/s].
constexpr double kVelocityError = 1e-6;

/// A contact whose frames move against each other: J v is not zero, so it opens or slides although it is held.
struct VelocityError {
  int contact = 0;
  double linear = 0, angular = 0;  // m/s, rad/s: |J v| over its linear and its angular rows
};

/// Of the contacts flagged `active`, those that v (scene.nv) at q (scene.nq) moves by kVelocityError or more.
/// make_consistent (analysis/consistent.hpp) mends them.
std::vector<VelocityError> velocity_errors(const Scene& scene, const std::vector<char>& active,
                                           const Eigen::Ref<const Eigen::VectorXd>& q,
                                           const Eigen::Ref<const Eigen::VectorXd>& v);

/// "0.5 m/s and 0.1 rad/s", likewise.
std::string in_words(const VelocityError& error);

/// What a unilateral contact with friction cannot do.
enum class Violating { kPulls, kSlips, kTips, kTurns };
/// "pulls", "slips", "tips", "turns".
std::string to_string(Violating kind);
/// Of Violation::by: "N", "N", "m", "N m".
std::string unit_of(Violating kind);

struct Violation {  // A force that no unilateral contact bears, and how far beyond.
  int contact = 0;
  Violating kind = Violating::kPulls;
  double by = 0;     // above 0, how far beyond what it bears: N of pull; N of tangential force; m from the centre of
                     // pressure to the box; N m of torque about the normal
  double needs = 0;  // kSlips: the mu that would do
};

/// Of the active contacts with a mu, those whose forces f at q (scene.nq; f_offset: as in Solution) no unilateral
/// contact bears, in the scene's order. With n the force along the contact's normal (contact/normal.hpp), t the
/// tangential one, and, in A's axes, (c_x, c_y) = (-m_y, m_x) / n the centre of pressure, l and w the sides of the box:
///
///     pulls: n < 0    slips: |t| > mu n    tips: |c_x| > l / 2 or |c_y| > w / 2
///     turns: m_z beyond what friction at the box's four corners gives (friction pyramid |t_x|, |t_y| <= mu n)
///
/// A contact that pulls does nothing else. What is below 1e-9 of the largest force on its robots counts as rounding.
/// Source of the last: Caron, Pham, Nakamura, Stability of surface contacts for humanoid robots, ICRA 2015.
std::vector<Violation> violations(const Scene& scene, const Eigen::Ref<const Eigen::VectorXd>& q,
                                  const Eigen::VectorXd& f, const std::vector<int>& f_offset);

/// What a contact of a linear force f (its rows) presses with at q (scene.nq): along its normal, and across it [N].
Eigen::Vector2d contact_pressure(const Scene& scene, int contact, const Eigen::Ref<const Eigen::VectorXd>& q,
                                 const Eigen::VectorXd& f);

enum class Limited { kPosition, kVelocity, kEffort };
/// "position", "velocity", "effort".
std::string to_string(Limited quantity);

/// A coordinate beyond a limit of the robot's file.
struct LimitPassed {
  int robot = 0, dof = 0;  // of that robot's velocity coordinates
  Limited quantity = Limited::kPosition;
  double value = 0, limit = 0;
};

/// At q, v, u (nq, nv, nu). Files write a velocity or effort of 0, or an empty range, where they know none: no limit.
std::vector<LimitPassed> limits_passed(const Scene& scene, const Eigen::Ref<const Eigen::VectorXd>& q,
                                       const Eigen::Ref<const Eigen::VectorXd>& v,
                                       const Eigen::Ref<const Eigen::VectorXd>& u);

/// How far a contact's acceleration is from what it asks for: |J a + a0 + delta f| over its linear and angular rows.
struct Contradiction {
  int contact = 0;
  double linear = 0, angular = 0;  // m/s^2, rad/s^2
};

/// Of the contacts of inconsistent islands, those that are missed by more than 1e-8 of the worst, which comes first.
/// After solve.
std::vector<Contradiction> contradictions(const Scene& scene, const SceneData& data);

/// Coordinates of a robot at q (its nq) in which its joint-space inertia, armature included, has nothing: pivots of its
/// leaf-to-root elimination that are rounding. Throws std::length_error for trees too deep for a joint-space inertia.
std::vector<int> massless_coordinates(const Robot& robot, const Eigen::Ref<const Eigen::VectorXd>& q);

/// A joint that makes the joint-space inertia singular, and why.
struct MasslessJoint {
  std::string joint;  // "r0/wrist"
  std::string why;    // no mass below it; or a moment of inertia that is missing; or what the joints below leave to it
};

/// Of all robots in islands that failed for want of inertia, each joint once. Of trees too deep for a joint-space
/// inertia those alone that have no mass below them. After solve.
std::vector<MasslessJoint> massless_joints(const Scene& scene, const SceneData& data,
                                           const Eigen::Ref<const Eigen::VectorXd>& q);

}  // namespace manycontact
