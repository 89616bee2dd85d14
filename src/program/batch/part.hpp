#pragma once
// A part of a scene: some of its islands, with the indices of their coordinates and rows in the whole scene.

#include "manycontact/detail/kkt/island.hpp"

namespace manycontact::cli {

/// `count` consecutive indices, from `whole` on in the whole scene, and from `own` on in the part.
struct Segment {
  int whole = 0, own = 0, count = 0;
};

struct ScenePart {
  Scene scene;                         // gravity and damping are the whole scene's
  std::vector<Segment> q, v, u, f;     // f: constraint rows of the part's contacts, all of which are active
  int nq = 0, nv = 0, nu = 0, nf = 0;  // sizes of the whole scene
  int own_nf = 0;
};

/// Returns part `number` of `parts`, with active contacts only. Parts are consecutive islands of about equal total
/// size. If an island has a contact on a robot's fixed base, that robot is in the same part. A part may be empty.
ScenePart part_of(const Scene& scene, int number, int parts);

/// Copy the part's numbers from an array of the whole scene (take), or into such an array (put).
void take(const std::vector<Segment>& segments, const double* whole, double* own);
void put(const std::vector<Segment>& segments, const double* own, double* whole);

}  // namespace manycontact::cli
