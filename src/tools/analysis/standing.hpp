#pragma once
// Tests whether robots can balance on their contacts: whether their centres of mass are above the supporting area.

#include <vector>

#include "manycontact/analysis/place.hpp"

namespace manycontact::internal {

struct Leaning {  // a robot whose centre of mass is not above the area that its contacts enclose
  int robot = 0;
  double by = 0;  // horizontal distance of the centre of mass from that area [m]
  std::vector<Attachment> feet;
};

/// Returns the leaning robots among those with a floating base that are supported only by ground contacts. `active`
/// flags the contacts. Returns none unless gravity is along the world's -z. A 6D contact without a box
/// counts as a human foot.
std::vector<Leaning> leaning(const Scene& scene, const std::vector<bool>& active, const ConstVectorRef& q);

/// standing_goal returns the goal that the centre of mass is above the middle of the feet. stance_goals returns goals
/// that keep the feet at their horizontal positions of q relative to each other.
Goal standing_goal(const Scene& scene, const Leaning& robot);
std::vector<Goal> stance_goals(const Scene& scene, const Leaning& robot, const ConstVectorRef& q);
/// Returns goals that keep the joints and the orientation of the robot's base as in q, each with the given weight.
std::vector<Goal> posture_goals(const Scene& scene, const Leaning& robot, const ConstVectorRef& q, double weight);

}  // namespace manycontact::internal
