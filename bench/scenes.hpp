#pragma once
// Scenes of the benchmarks, made in code: every robot has the same asymmetric configuration and motion.

#include <string>

#include "manycontact/model/scene.hpp"

namespace manycontact::bench {

/// A scene at a state with consistent contacts without errors: J v = 0.
struct Posed {
  Scene scene;
  Eigen::VectorXd q, v, u;
};

/// Returns the name of the measured robot (settings().robot): its file's name without folder and extension.
std::string robot_name();
/// Returns "left_sole right_sole, hands left_hand right_hand": the frames that are fixed.
std::string robot_frames();

/// Returns `count` measured robots in a circle, feet fixed in 6D; hand in hand: a closed ring by 6D contacts.
Posed robots(int count, bool hand_in_hand = false);
/// Returns one measured robot on `points` 3D points of its soles; all but the first point of a sole are redundant.
Posed on_points(int points);
/// Returns 16 quadrupeds of models/, of whose 64 point feet `held` are fixed.
Posed herd_on_feet(int held);
/// Returns `count` quadrupeds of models/, each on its four point feet.
Posed herd(int count);
/// Returns boxes of models/ on each other, each on four points of the one below, the lowest on the ground.
Posed tower(int boxes);
/// Returns boxes in rows on a large one that is on the ground, each on four points.
Posed table(int boxes);
/// Returns boxes in a square, attached to their neighbours by points, the lowest row welded to the ground: a sixth of
/// the rows depend on others around loops of bodies. boxes: a square number.
Posed wall(int boxes);
/// Returns a chain of revolute joints with every tenth link fixed in 6D.
Posed chain(int links);

}  // namespace manycontact::bench
