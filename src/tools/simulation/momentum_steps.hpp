#pragma once
// Functions shared by the end of a step (detail/simulation/momentum.hpp) and its derivatives.

#include <span>

#include "manycontact/detail/simulation/momentum.hpp"

namespace manycontact::internal {

inline FreeGroup& group_at(FreeGroups& groups, int node) { return groups.groups[groups.group[node]]; }
inline const FreeGroup& group_at(const FreeGroups& groups, int node) { return groups.groups[groups.group[node]]; }

/// Calls use(group, sign) for the groups that a free joint moves: the group on the child side with sign 1, and the
/// group on the parent side with sign -1. Skips groups tied to the world, and joints within one group.
template <class Groups, class Use>
void each_side(Groups& groups, const FreeGroups::FreeJoint& j, Use&& use) {
  if (groups.group[j.node] == groups.group[j.parent]) return;
  if (auto& group = group_at(groups, j.node); !group.tied) use(group, 1.0);
  if (auto& group = group_at(groups, j.parent); !group.tied) use(group, -1.0);
}

/// Return the displacement, and the velocity at the point `at`, that end_free_motion adds to a free joint (world axes).
Vec3<double> added_displacement(const FreeGroups& groups, const FreeGroups::FreeJoint& j);
Vec6<double> added_velocity(const FreeGroups& groups, const FreeGroups::FreeJoint& j, const Vec3<double>& at);

/// Sets and returns groups.any, whether a group is free. Needs no kinematics, unlike begin_free_motion.
bool find_free_groups(const Scene& scene, const std::vector<char>& active, FreeGroups& groups);
/// Computes placements and velocities of all robots, without accelerations.
void kinematics_at(const Scene& scene, const ConstVectorRef& q, const ConstVectorRef& v,
                   std::vector<Kinematics<double>>& kin);
Vec3<double> place_of(const Attachment& at, const std::vector<Kinematics<double>>& kin);
/// Computes inertia and momentum of every free group about its reference point.
void measure(const Scene& scene, const std::vector<Kinematics<double>>& kin, FreeGroups& groups);
/// Returns the group's angular momentum about its centre of mass C. C is relative to the group's reference.
Vec3<double> spin(const FreeGroup& group, const Vec3<double>& C);
/// If the group moves in a plane, removes the components of x across it.
void in_the_plane(const FreeGroup& group, Vec3<double>& x);
/// Returns the angular velocity dw with I dw = dL. dw is 0 about axes without inertia, and normal to a group's plane.
Vec3<double> turn_for(const FreeGroup& group, const Mat3<double>& I, const Vec3<double>& dL);

struct OneBody {  // the rigid body that several free groups would form if they did not move relative to each other
  double m = 0;
  Vec3<double> C = Vec3<double>::Zero();
  Mat3<double> I = Mat3<double>::Zero();         // inertia about C
  FreeGroup plane;                               // plane of motion, if one of the groups has one
  Vec3<double> V = Vec3<double>::Zero(), w = V;  // velocity from the groups' momentum
};
/// Combines the groups `members`, for which `measure` was called, to one rigid body.
OneBody one_body(std::span<const int> members, const FreeGroups& groups);

inline Vec3<double> centre_of(const FreeGroup& group) { return group.reference + group.Y.h / group.Y.m; }
inline Mat3<double> joint_space_inertia(const FreeGroup& group) { return group.Y.seen_at(-group.Y.h / group.Y.m).I; }

/// Expands a motion or wrench in a free joint's coordinates to the six components of a floating joint (child's axes).
template <class V>
Vec6<double> as_floating(const Joint& joint, const V& x) {
  Vec6<double> out = Vec6<double>::Zero();
  if (joint.type == JointType::kPlanar)
    out[0] = x[0], out[1] = x[1], out[5] = x[2];
  else
    out = x;
  return out;
}

/// Adds a motion in the child's axes to a free joint's coordinates; for a planar joint, its components in the plane.
template <class V>
void add_motion(const Joint& joint, const Vec3<double>& linear, const Vec3<double>& angular, V& to) {
  if (joint.type == JointType::kPlanar) {
    to[0] += linear[0], to[1] += linear[1], to[2] += angular[2];
  } else {
    to.template segment<3>(0) += linear, to.template segment<3>(3) += angular;
  }
}

}  // namespace manycontact::internal
