#pragma once
// Free groups of bodies (simulation/momentum.hpp) as one rigid body.

#include <span>

#include "momentum_steps.hpp"

namespace manycontact::internal {

struct OneBody {
  double m = 0;
  Vec3<double> C = Vec3<double>::Zero();
  Mat3<double> I = Mat3<double>::Zero();         // about C
  FreeGroup plane;                               // that it moves in, where one of its groups does
  Vec3<double> V = Vec3<double>::Zero(), w = V;  // its velocity by the groups' momentum
};
/// The body that consists of the groups `members` where they were measured.
OneBody one_body(std::span<const int> members, const FreeGroups& groups);

/// The centre of mass of a group in the world.
inline Vec3<double> centre_of(const FreeGroup& group) { return group.reference + group.Y.h / group.Y.m; }
/// Its inertia about that.
inline Mat3<double> inertia_of(const FreeGroup& group) { return group.Y.seen_at(-group.Y.h / group.Y.m).I; }

}  // namespace manycontact::internal
