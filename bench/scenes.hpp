#pragma once
// Scenes of the benchmarks, made in code: every robot in a posture and motion without symmetry, all alike.

#include <string>

#include "manycontact/model/scene.hpp"

namespace manycontact::bench {

/// A scene at a state, in which contacts neither err nor move: J v = 0.
struct Posed {
  Scene scene;
  Eigen::VectorXd q, v, u;
};

/// What the measured robot (settings().robot) is called: its file's name without folder and extension.
std::string robot_name();
/// "left_sole right_sole, hands left_hand right_hand": the frames it is held by.
std::string robot_frames();

/// The measured robot, `count` times in a circle, both feet held in 6D; hand in hand: in a closed ring by 6D contacts.
Posed robots(int count, bool hand_in_hand = false);
/// One of them on `points` points of its two soles, held in 3D: from the second of a sole on they depend on each other.
Posed on_points(int points);
/// 16 quadrupeds of models/, of whose 64 point feet `held` are.
Posed herd_on_feet(int held);
/// `count` quadrupeds of models/, each on its four point feet.
Posed herd(int count);
/// Boxes of models/ on each other, each on four points of the one below, the lowest on the ground.
Posed tower(int boxes);
/// Boxes side by side on a large one that stands on the ground, each on four points.
Posed table(int boxes);
/// Boxes in a square, held to their neighbours by points, the lowest row welded to the ground: a sixth of the rows depend
/// on others around loops of bodies. boxes: a square number.
Posed wall(int boxes);
/// A chain of revolute joints whose every tenth link is held in 6D.
Posed chain(int links);

}  // namespace manycontact::bench
