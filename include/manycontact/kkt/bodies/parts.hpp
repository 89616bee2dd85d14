#pragma once
// Trees cut at held bodies. Six independent rows between a body and what stands still say all of its acceleration, so
// what hangs below it is a system (system.hpp) of its own, with a base that moves as told; it pulls at the body, which
// these rows' forces alone feel.

#include <memory>

#include "manycontact/kkt/bodies/pattern.hpp"

namespace manycontact {

/// A body that six rows hold, a leaf in its own part.
struct BodyCut {
  int node = 0;   // in its own part
  int below = 0;  // the part that hangs on it
  int row[6];     // of its own part
};

/// Constant; its nodes, coordinates and rows are numbered in the order of the island's.
struct BodyPart {
  std::shared_ptr<const BodyPattern> pattern;  // alike parts share one
  int shape = 0;                               // its number among the patterns
  int above = -1;                              // the cut on which its bases hang; -1: they stand on nothing
  std::vector<int> node, contact;              // of the island
  int first_cut = 0, end_cut = 0;              // those in this part
};

struct BodyParts {
  std::vector<BodyPart> parts;  // each after the one that it hangs on
  std::vector<BodyCut> cuts;
};

/// Cuts wherever six rows to what stands still hold a body and no row of another body goes past it. Linear cost, as
/// analyze_bodies.
BodyParts split_bodies(const Island& island, const BodyPattern& whole);

}  // namespace manycontact
