#pragma once
// A scene made of some islands of another scene, with their coordinates' and rows' indices in the whole scene.

#include "manycontact/detail/kkt/island.hpp"

namespace manycontact::cli {

/// `count` consecutive indices, from `whole` on in the whole scene, and from `own` on in the part.
struct Segment {
  int whole = 0, own = 0, count = 0;
};

struct ScenePart {
  Scene scene;                         // gravity and damping are the whole scene's
  std::vector<Segment> q, v, u, f;     // f: constraint rows of active contacts, which are all contacts of the part
  int nq = 0, nv = 0, nu = 0, nf = 0;  // sizes of the whole scene
  int own_nf = 0;
};

/// Returns part `number` of `parts`, with active contacts only. Parts are consecutive islands of about equal total
/// size. An island with a contact on another robot's fixed base goes with that robot's island. A part may be empty.
ScenePart part_of(const Scene& scene, int number, int parts);

/// Copy the part's numbers from those of the whole scene (take), and back (put).
void take(const std::vector<Segment>& segments, const double* whole, double* own);
void put(const std::vector<Segment>& segments, const double* own, double* whole);

}  // namespace manycontact::cli
