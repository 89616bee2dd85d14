#pragma once
// Division of trees at bodies whose acceleration six independent rows to the world or a fixed base determine. The
// subtree below is an independent system (system.hpp), and the forces of the six rows balance its reaction.

#include <memory>

#include "manycontact/kkt/bodies/pattern.hpp"

namespace manycontact {

/// A body constrained by six rows: a leaf of the subtree above, its own subtree, and the base of the subtree below.
struct BodyCut {
  int node = 0;   // index of the body in its own subtree
  int below = 0;  // index of the subtree below the body
  int row[6];     // indices of the six rows in the body's own subtree
};

/// A part of a tree between cuts. Its nodes, coordinates and rows are in the island's order.
struct BodySubtree {
  std::shared_ptr<const BodyPattern> pattern;  // shared by subtrees of one shape
  int shape = 0;                               // index of its pattern: subtrees of one shape share one
  int above = -1;                              // index of the cut to which its bases are attached; -1: none
  std::vector<int> node, contact;              // indices of its nodes and contacts in the island
  int first_cut = 0, end_cut = 0;              // range of the cuts at its leaves
};

struct BodySubtrees {
  std::vector<BodySubtree> subtrees;  // each subtree after the subtree above it
  std::vector<BodyCut> cuts;
};

/// Whether any body with children is constrained by six rows, so that trees may be cut.
bool may_be_cut(const BodyPattern& p);

/// Cuts trees at each body that six rows fix to the world or a fixed base, unless a row of another body couples the two
/// sides of the cut. The cost is linear.
BodySubtrees split_bodies(const Island& island, const BodyPattern& whole);

}  // namespace manycontact
