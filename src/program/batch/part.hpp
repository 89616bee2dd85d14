#pragma once
// A scene made of some islands of another scene, with the indices of its coordinates, rows and contacts in the whole
// scene.

#include "manycontact/detail/kkt/island.hpp"

namespace manycontact::cli {

/// `count` neighbours: from `whole` in the whole scene's numbers, from `own` in the part's.
struct Segment {
  int whole = 0, own = 0, count = 0;
};

struct ScenePart {
  Scene scene;                         // gravity and damping are the whole scene's
  std::vector<Segment> q, v, u, f;     // f: constraint rows of active contacts, which are all contacts of the part
  int nq = 0, nv = 0, nu = 0, nf = 0;  // sizes of the whole scene
  int own_nf = 0;
};

/// The islands that the scene's active contacts make, without contacts that are not active. `number` of `parts`: their
/// neighbouring islands, so cut that all have about as many velocities and forces; an island with a contact on another
/// robot's fixed base goes with that robot's. Some may be empty.
ScenePart part_of(const Scene& scene, int number, int parts);

/// Whole rows to the part's and back.
void take(const std::vector<Segment>& segments, const double* whole, double* own);
void put(const std::vector<Segment>& segments, const double* own, double* whole);

}  // namespace manycontact::cli
