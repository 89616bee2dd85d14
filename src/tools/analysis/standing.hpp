#pragma once
// Whether robots can balance on their contacts, judged by the positions of their centres of mass.

#include <vector>

#include "manycontact/analysis/place.hpp"

namespace manycontact::internal {

/// A robot whose centre of mass is not above the area that its contacts enclose.
struct Leaning {
  int robot = 0;
  double by = 0;  // horizontal distance [m]
  std::vector<Attachment> feet;
};

/// Checks robots with a floating base under gravity along the world's -z that are supported only by contacts with the
/// ground, flagged `active`. A contact that transmits moments and has no box is assumed to be as large as a foot.
std::vector<Leaning> leaning(const Scene& scene, const std::vector<bool>& active, const ConstVectorRef& q);

/// Goals: the centre of mass is above the middle of the feet; the feet keep their horizontal distances at q.
Goal standing_goal(const Scene& scene, const Leaning& robot);
std::vector<Goal> stance_goals(const Scene& scene, const Leaning& robot, const ConstVectorRef& q);
/// Goals that keep the robot's joints and the axes of its base as at q, each with the given weight.
std::vector<Goal> posture_goals(const Scene& scene, const Leaning& robot, const ConstVectorRef& q, double weight);

}  // namespace manycontact::internal
