#pragma once
// Free groups of bodies (detail/simulation/momentum.hpp) as one rigid body.

#include <span>

#include "momentum_steps.hpp"

namespace manycontact::internal {

struct OneBody {
  double m = 0;
  Vec3<double> C = Vec3<double>::Zero();
  Mat3<double> I = Mat3<double>::Zero();         // inertia about C
  FreeGroup plane;                               // the plane that it moves in, if one of its groups moves in a plane
  Vec3<double> V = Vec3<double>::Zero(), w = V;  // velocity computed from the groups' momentum
};
/// Returns the rigid body that consists of the groups `members` where they were measured.
OneBody one_body(std::span<const int> members, const FreeGroups& groups);

/// Returns the centre of mass of a group in the world.
inline Vec3<double> centre_of(const FreeGroup& group) { return group.reference + group.Y.h / group.Y.m; }
/// Returns the inertia of a group about its centre of mass.
inline Mat3<double> joint_space_inertia(const FreeGroup& group) { return group.Y.seen_at(-group.Y.h / group.Y.m).I; }

}  // namespace manycontact::internal
