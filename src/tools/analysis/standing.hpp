#pragma once
// Whether robots could stand on their contacts, judged by the positions of their centres of mass over these.

#include <vector>

#include "manycontact/analysis/place.hpp"

namespace manycontact::internal {

/// A robot whose centre of mass is not above what its contacts enclose.
struct Leaning {
  int robot = 0;
  double by = 0;  // m, horizontally
  std::vector<Attachment> feet;
};

/// Checks robots with a floating base under gravity along the world's -z that are supported only by contacts with the
/// ground, flagged `active`. A contact that transmits moments and has no box is assumed to be as large as a foot.
std::vector<Leaning> leaning(const Scene& scene, const std::vector<bool>& active, const ConstVectorRef& q);

/// The centre of mass above the middle of the feet; and these as far apart, horizontally, as they are at q.
Goal standing_goal(const Scene& scene, const Leaning& robot);
std::vector<Goal> stance_goals(const Scene& scene, const Leaning& robot, const ConstVectorRef& q);
/// The robot's joints and the axes of its base as they are at q, for little: of weight `weight` each.
std::vector<Goal> posture_goals(const Scene& scene, const Leaning& robot, const ConstVectorRef& q, double weight);

}  // namespace manycontact::internal
