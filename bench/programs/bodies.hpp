#pragma once
// A scene as bodies and contacts between them, from which peers' models are built. Bodies have their placements at the
// scene's q, so that a peer's joints are at zero there.

#include <vector>

#include "../scenes.hpp"

namespace manycontact::bench {

struct Body {
  int parent;             // index of the parent; -1: the world
  JointType type;         // revolute or floating
  SE3<double> in_parent;  // at q
  SE3<double> in_world;   // at q
  Vec3<double> axis;      // axis of a revolute joint, in the body's frame
  double mass;
  Vec3<double> com;      // in the body's frame
  Mat3<double> inertia;  // about the centre of mass
  int idx_v, idx_u;      // indices in the scene's v and u; idx_u -1: a floating base
};

struct Hold {
  bool point;              // true: 3D, false: 6D
  int a, b;                // bodies; b -1: the world
  SE3<double> in_a, in_b;  // the placement that they share, in each body
};

/// List bodies, parents before children, and contacts. Throw std::invalid_argument for other joints or contacts.
std::vector<Body> bodies_of(const Posed& scene);
std::vector<Hold> holds_of(const Posed& scene, const std::vector<Body>& bodies);

/// Returns the reason why these functions would throw, or nothing.
std::string strange(const Posed& scene);

}  // namespace manycontact::bench
