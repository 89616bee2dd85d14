#pragma once
// Trees cut at constrained bodies. Six independent rows between a body and the world or a base determine its
// acceleration, so the subtree below is an independent system (system.hpp); the rows' forces balance its reaction.

#include <memory>

#include "manycontact/kkt/bodies/pattern.hpp"

namespace manycontact {

/// A body constrained by six rows, a leaf in its own subtree.
struct BodyCut {
  int node = 0;   // index in its own subtree
  int below = 0;  // the subtree below it
  int row[6];     // indices in its own subtree
};

/// Constant data; nodes, coordinates and rows are in the island's order.
struct BodySubtree {
  std::shared_ptr<const BodyPattern> pattern;  // shared by subtrees of one shape
  int shape = 0;                               // index of its pattern
  int above = -1;                              // the cut that its bases are attached to; -1: none
  std::vector<int> node, contact;              // indices in the island
  int first_cut = 0, end_cut = 0;              // range of cuts in this subtree
};

struct BodySubtrees {
  std::vector<BodySubtree> subtrees;  // each after the one above it
  std::vector<BodyCut> cuts;
};

/// Whether any body with children is constrained by six rows, so that trees may be cut.
bool may_be_cut(const BodyPattern& p);

/// Cuts at each body that six rows fix to the world or a base, unless another body's row crosses; linear cost.
BodySubtrees split_bodies(const Island& island, const BodyPattern& whole);

}  // namespace manycontact
