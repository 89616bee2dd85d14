#pragma once
// Free groups of bodies (simulation/momentum.hpp) that move as one rigid body.

#include <span>

#include "momentum_steps.hpp"

namespace manycontact::internal {

/// A part of it: a free group at the start of a step, and its momentum at the end.
struct PartOfBody {
  double m;
  Vec3<double> C;       // in the world
  Mat3<double> I;       // about C
  Vec3<double> P, L;    // L about C
  Vec3<double> C_next;  // as FreeGroup::C_next
};
/// The part of a group whose Y is that of the start.
PartOfBody part_of(const FreeGroup& group);

struct OneBody {
  double m = 0;
  Vec3<double> C = Vec3<double>::Zero();
  Mat3<double> I = Mat3<double>::Zero();         // about C
  FreeGroup plane;                               // that it moves in, where one of its parts does
  Vec3<double> L = Vec3<double>::Zero();         // about C, of all parts
  Vec3<double> V = Vec3<double>::Zero(), w = V;  // its velocity by the parts' momentum
};
/// The body that consists of the groups `members` with their parts. moves: else V = w = 0.
OneBody one_body(std::span<const int> members, const std::vector<PartOfBody>& parts, const FreeGroups& groups,
                 bool moves);

/// Gives the groups what the parts have.
void keep_all(std::span<const int> members, const std::vector<PartOfBody>& parts, FreeGroups& groups);
/// Gives the groups, after a step of h, a share of what the parts have, and for the rest the motion of the one body.
/// If it moves, the sum of the parts' momentum is kept to rounding errors.
void approach(const OneBody& body, std::span<const int> members, const std::vector<PartOfBody>& parts, double share,
              bool moves, double h, FreeGroups& groups);

}  // namespace manycontact::internal
