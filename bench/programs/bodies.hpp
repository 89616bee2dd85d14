#pragma once
// A scene is listed as bodies and the contacts between them, from which peers are built. Bodies are where the scene's q
// has them, so that a peer's joints are at zero there.

#include <vector>

#include "../scenes.hpp"

namespace manycontact::bench {

struct Body {
  int parent;             // body, -1: the world
  JointType type;         // revolute or floating
  SE3<double> in_parent;  // at q
  SE3<double> in_world;   // at q
  Vec3<double> axis;      // of a revolute joint, in the body's frame
  double mass;
  Vec3<double> com;      // in the body's frame
  Mat3<double> inertia;  // about the centre of mass
  int idx_v, idx_u;      // in the scene's v and u; idx_u -1: a floating base
};

struct Hold {
  bool point;              // 3D, else 6D
  int a, b;                // bodies; b -1: the world
  SE3<double> in_a, in_b;  // the place they share
};

/// Parents come before children. Throws std::invalid_argument for a joint or contact that is neither of the above.
std::vector<Body> bodies_of(const Posed& scene);
std::vector<Hold> holds_of(const Posed& scene, const std::vector<Body>& bodies);

/// Returns an empty string if the two above accept the scene, otherwise the reason.
std::string strange(const Posed& scene);

}  // namespace manycontact::bench
