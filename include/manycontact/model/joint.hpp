#pragma once
// Joints with a constant motion subspace: a joint's columns S_i (6 x nv) are constant in the joint's child frame.

#include <string>

#include "manycontact/spatial/inertia.hpp"

namespace manycontact {

using JointIndex = int;    // number of a joint in its model
using RobotIndex = int;    // number of a robot in its scene
using ContactIndex = int;  // number of a contact in its scene

/// Joint types.
enum class JointType {
  kRevolute,   // q: angle [rad], about `axis`; also used for continuous joints
  kPrismatic,  // q: displacement [m] along `axis`
  kFloating,   // q: x y z [m], qx qy qz qw; v: spatial velocity in the child frame, linear first
  kPlanar,     // q: x y [m], angle [rad]; v in the moving frame; the plane's normal is z of the joint frame
};

/// Returns the number of coordinates that a joint of this type has in q.
constexpr int joint_nq(JointType t) { return t == JointType::kFloating ? 7 : t == JointType::kPlanar ? 3 : 1; }
/// Returns the number of coordinates that a joint of this type has in v.
constexpr int joint_nv(JointType t) { return t == JointType::kFloating ? 6 : t == JointType::kPlanar ? 3 : 1; }

/// The length below which a direction vector counts as zero, since it may be a rounding error of a file or of a
/// difference.
constexpr double kZeroDirection = 1e-9;

/// One joint and the body that it moves. The joint frame is fixed to the parent body, and the child frame to the moved
/// body. Both frames coincide in the neutral configuration.
struct Joint {
  std::string name;
  JointType type = JointType::kRevolute;
  JointIndex parent = -1;  // number of the parent joint; -1: the robot's base
  int idx_q = 0, idx_v = 0;
  SE3<double> placement;                      // placement of the joint frame in the parent joint's frame
  Vec3<double> axis = Vec3<double>::UnitZ();  // unit vector in the joint frame (revolute, prismatic)
  Inertia<double> inertia;                    // inertia of the body with its fixed links, in the child frame
  /// Limits, one value per velocity coordinate; infinite if the file has none.
  Eigen::VectorXd lower, upper;  // position [rad, m]; unused for floating joints
  Eigen::VectorXd velocity_limit, effort_limit;
  bool actuated = true;  // whether the joint has torques in u; always false for floating bases

  int nq() const { return joint_nq(type); }  // numbers in q
  int nv() const { return joint_nv(type); }  // numbers in v

  // These members are computed by finalize(Model&), to save work in recursions over the joints.
  int axis_kind = 3;              // 0, 1, 2: axis is +x, +y, +z; 3: any other axis
  bool placement_rotates = true;  // whether placement.R differs from the identity
};

}  // namespace manycontact
