#pragma once
// A part of a scene consists of some of its islands, with the indices of their coordinates and rows in the whole scene.

#include "manycontact/detail/kkt/island.hpp"

namespace manycontact::cli {

struct Segment {  // a range of `count` indices that starts at `whole` in the whole scene, and at `own` in the part
  int whole = 0, own = 0, count = 0;
};

struct ScenePart {
  Scene scene;                         // has gravity and damping of the whole scene
  std::vector<Segment> q, v, u, f;     // coordinates, torques, and constraint rows of the contacts, all active
  int nq = 0, nv = 0, nu = 0, nf = 0;  // sizes of the whole scene
  int own_nf = 0;
};

/// Returns part `number` of `parts`, which contains only active contacts. Parts are consecutive islands of about equal
/// total size. If an island has a contact on a robot's fixed base, that robot is in the same part. A part may be empty.
ScenePart part_of(const Scene& scene, int number, int parts);

/// take copies the part's numbers from an array of the whole scene; put copies them into such an array.
void take(const std::vector<Segment>& segments, const double* whole, double* own);
void put(const std::vector<Segment>& segments, const double* own, double* whole);

}  // namespace manycontact::cli
