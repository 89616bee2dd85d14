#pragma once
// Tests whether robots can balance on their contacts: whether their centres of mass are above the supporting area.

#include <vector>

#include "manycontact/analysis/place.hpp"

namespace manycontact::internal {

/// A robot whose centre of mass is not above the area that its contacts enclose.
struct Leaning {
  int robot = 0;
  double by = 0;  // horizontal distance of the centre of mass from that area [m]
  std::vector<Attachment> feet;
};

/// Lists leaning robots among those with a floating base that only contacts with the ground, flagged `active`, support.
/// Gravity must be along the world's -z. A 6D contact without a box is assumed to be as large as a foot.
std::vector<Leaning> leaning(const Scene& scene, const std::vector<bool>& active, const ConstVectorRef& q);

/// Return goals: the centre of mass is above the middle of the feet; the feet keep the horizontal distances of q.
Goal standing_goal(const Scene& scene, const Leaning& robot);
std::vector<Goal> stance_goals(const Scene& scene, const Leaning& robot, const ConstVectorRef& q);
/// Goals that keep the robot's joints and the axes of its base as at q, each with the given weight.
std::vector<Goal> posture_goals(const Scene& scene, const Leaning& robot, const ConstVectorRef& q, double weight);

}  // namespace manycontact::internal
