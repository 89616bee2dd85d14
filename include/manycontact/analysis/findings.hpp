#pragma once
// Checks of a scene and its solution that no status covers. They find contacts that start out of place or moving,
// forces that a unilateral contact cannot exert, contradicting contacts, exceeded joint limits, and joints without
// inertia.

#include <string>
#include <vector>

#include "manycontact/dynamics/data.hpp"
#include "manycontact/dynamics/quasi_static.hpp"

namespace manycontact {

/// Placement errors below this threshold are attributed to rounded numbers in files [m, rad].
constexpr double kPlacementError = 1e-6;

/// A contact whose frame A is not where the contact requires it relative to its target frame B'.
struct PlacementError {
  ContactIndex contact = 0;
  double position = 0;  // m: |p_A - p_B'| along the constraint rows
  double angle = 0;     // rad: angle between the axes of A and B' (6D), or between the hinge axes (5D); 0 for points
};

/// Lists those contacts flagged `active` whose placement error at q (scene.nq) is kPlacementError or more. Throws
/// std::invalid_argument for wrong sizes. Thread-safe.
std::vector<PlacementError> placement_errors(const Scene& scene, const ConstVectorRef& q,
                                             const std::vector<char>& active);

/// Describes an error: "0.1 m and 0.02 rad", without negligible parts.
std::string in_words(const PlacementError& error);

/// Velocity errors below this threshold are attributed to rounded numbers in files [m/s, rad/s].
constexpr double kVelocityError = 1e-6;

/// A contact whose frames move relative to each other: J v is not zero, although the contact is bilateral.
struct VelocityError {
  ContactIndex contact = 0;
  double linear = 0, angular = 0;  // m/s, rad/s: |J v| for its linear and its angular rows
};

/// Lists those contacts flagged `active` that move by kVelocityError or more at q (scene.nq), v (scene.nv). To correct
/// q and v, use make_consistent (analysis/consistent.hpp). Throws std::invalid_argument for wrong sizes. Thread-safe.
std::vector<VelocityError> velocity_errors(const Scene& scene, const ConstVectorRef& q, const ConstVectorRef& v,
                                           const std::vector<char>& active);

/// Describes an error: "0.5 m/s and 0.1 rad/s", without negligible parts.
std::string in_words(const VelocityError& error);

/// Returns the name of the coordinate that no torques keep at rest: "r0/pole".
std::string name_of(const Scene& scene, const Unbalanced& unbalanced);
/// Describes the unbalanced load: "no torques keep it at rest in this configuration: 1.9 N m of its load remain".
std::string in_words(const Unbalanced& unbalanced);

/// The threshold of TurningRows::rate [m/s^2]. Lower rates are attributed to rounded numbers in files.
constexpr double kTurningRows = 1e-6;

/// A 1D or 2D contact whose rows rotate while its point moves across them: rows in local axes on a rotating body A, or
/// in world axes with a rotating frame B'. With J a + a0 = 0 (`solve`) the row velocity J v is then not constant.
struct TurningRows {
  ContactIndex contact = 0;
  double rate = 0;  // m/s^2: rate of J v in `solve` (J a + a0 = 0) with gains of zero
};

/// Lists those contacts flagged `active` whose rate is kTurningRows or more at q (scene.nq), v (scene.nv). J v changes
/// at that rate with `solve`; `step` keeps J v constant. Throws std::invalid_argument for wrong sizes. Thread-safe.
std::vector<TurningRows> turning_rows(const Scene& scene, const ConstVectorRef& q, const ConstVectorRef& v,
                                      const std::vector<char>& active);

/// The conditions of a unilateral contact with friction that a force can violate: it pulls, slips, tips or turns.
enum class ViolationKind { kPulls, kSlips, kTips, kTurns };
/// Returns the kind's name: "pulls", "slips", "tips", "turns".
std::string to_string(ViolationKind kind);
/// Returns the unit of Violation::by for a kind: "N", "N", "m", "N m".
std::string unit_of(ViolationKind kind);

struct Violation {  // A contact force that a unilateral contact cannot exert, and by how much.
  ContactIndex contact = 0;
  ViolationKind kind = ViolationKind::kPulls;
  double by = 0;     // the excess, above 0: N of pull; N of tangential force; m from the centre of pressure to the box;
                     // N m of torque about the normal
  double needs = 0;  // kSlips: the friction coefficient that would be sufficient
};

/// Lists the active contacts with a mu whose forces f at q (scene.nq) no unilateral contact can exert, in the scene's
/// order. f, f_offset: as in Solution. Let n be the force along the contact's normal, t the tangential force,
/// and (c_x, c_y) = (-m_y, m_x) / n the centre of pressure in A's axes. With l, w the sides of the box:
///
///     pulls: n < 0    slips: |t| > mu n    tips: |c_x| > l / 2 or |c_y| > w / 2
///     turns: m_z exceeds the friction at the four corners of the box (friction pyramid |t_x|, |t_y| <= mu n)
///
/// For a contact that pulls, nothing else is tested. Forces below 1e-9 of the largest force on the same robots, or of
/// their weights, are treated as rounding errors. Throws std::invalid_argument for wrong sizes. Thread-safe. Source of
/// the last condition: Caron, Pham, Nakamura, Stability of surface contacts for humanoid robots, ICRA 2015.
std::vector<Violation> violations(const Scene& scene, const ConstVectorRef& q, const Eigen::VectorXd& f,
                                  const std::vector<int>& f_offset);
/// Lists violations as the first overload does. The scale of rounding errors is given by `loads` [N], one per robot,
/// instead of the weights. In a step of semi-implicit Euler the loads include momenta divided by the step size.
std::vector<Violation> violations(const Scene& scene, const ConstVectorRef& q, const Eigen::VectorXd& f,
                                  const std::vector<int>& f_offset, const Eigen::VectorXd& loads);
/// Returns the weights of the robots [N].
Eigen::VectorXd robot_weights(const Scene& scene);

/// Returns normal and tangential component [N] of a contact's linear force at q (scene.nq). f: the contact's rows only.
Eigen::Vector2d contact_pressure(const Scene& scene, ContactIndex contact, const ConstVectorRef& q,
                                 const Eigen::VectorXd& f);

/// The quantities that have limits.
enum class LimitKind { kPosition, kVelocity, kEffort };
/// Returns the quantity's name: "position", "velocity", "effort".
std::string to_string(LimitKind quantity);

/// A coordinate that exceeds a limit of the robot's file.
struct LimitPassed {
  RobotIndex robot = 0;
  int dof = 0;  // index of a velocity coordinate of the robot
  LimitKind quantity = LimitKind::kPosition;
  double value = 0, limit = 0;
};

/// Lists exceeded limits at q (nq), v (nv), u (nu). Velocity or effort limits of 0 are ignored, as files use 0 for
/// unknown. Equal lower and upper limits are tested too. Throws std::invalid_argument for wrong sizes. Thread-safe.
std::vector<LimitPassed> limits_passed(const Scene& scene, const ConstVectorRef& q, const ConstVectorRef& v,
                                       const ConstVectorRef& u);

/// The residual of a contact's acceleration equation: |J a + a0 + delta f|, with a0 the bias and delta the damping.
struct Contradiction {
  ContactIndex contact = 0;
  double linear = 0, angular = 0;  // m/s^2, rad/s^2
};

/// Lists the contacts of inconsistent islands, the worst first, without contacts that have less than 1e-8 of the worst
/// residual. Throws std::logic_error before a solve.
std::vector<Contradiction> contradictions(const Scene& scene, const SceneData& data);

/// Returns the coordinates of a robot that have no inertia, and no armature, at q (the robot's nq). Their pivots in the
/// leaf-to-root elimination of M are rounding errors. Throws std::length_error for trees too deep for a joint-space
/// inertia.
std::vector<int> massless_coordinates(const Robot& robot, const ConstVectorRef& q);

/// A joint that makes the joint-space inertia singular, and the cause.
struct MasslessJoint {
  std::string joint;  // "r0/wrist"
  std::string why;    // no mass below it, or a missing moment of inertia, or no inertia left by the joints below
};

/// Lists each massless joint of the robots in islands that failed for lack of inertia. In trees too deep for a
/// joint-space inertia, only joints without mass below them are found. Throws std::logic_error before a solve at q
/// (nq).
std::vector<MasslessJoint> massless_joints(const Scene& scene, const SceneData& data, const ConstVectorRef& q);

}  // namespace manycontact
