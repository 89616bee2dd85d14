#pragma once
// Trees cut at held bodies. Six independent rows between a body and what stands still say all of its acceleration, so
// what hangs below it is a system (system.hpp) of its own, with a base that moves as told; it pulls at the body, which
// these rows' forces alone feel.

#include <memory>

#include "manycontact/kkt/bodies/pattern.hpp"

namespace manycontact {

/// A body that six rows hold, a leaf in its own subtree.
struct BodyCut {
  int node = 0;   // in its own subtree
  int below = 0;  // the subtree that hangs on it
  int row[6];     // of its own subtree
};

/// Constant; its nodes, coordinates and rows are numbered in the order of the island's.
struct BodySubtree {
  std::shared_ptr<const BodyPattern> pattern;  // alike subtrees share one
  int shape = 0;                               // its number among the patterns
  int above = -1;                              // the cut on which its bases hang; -1: they stand on nothing
  std::vector<int> node, contact;              // of the island
  int first_cut = 0, end_cut = 0;              // those in this subtree
};

struct BodySubtrees {
  std::vector<BodySubtree> subtrees;  // each after the one that it hangs on
  std::vector<BodyCut> cuts;
};

/// Whether there is a body to cut at: with others below it, held by six rows.
bool may_be_cut(const BodyPattern& p);

/// Cuts wherever six rows to what stands still hold a body and no row of another body goes past it. Linear cost, as
/// analyze_bodies.
BodySubtrees split_bodies(const Island& island, const BodyPattern& whole);

}  // namespace manycontact
