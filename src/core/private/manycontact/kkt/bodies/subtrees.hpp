#pragma once
// Trees cut at constrained bodies. Six independent rows between a body and the world or a base determine its
// acceleration. The subtree below is then an independent system (system.hpp), whose reaction the rows' forces balance.

#include <memory>

#include "manycontact/kkt/bodies/pattern.hpp"

namespace manycontact {

/// A body constrained by six rows; trees are cut there. It is a leaf of its own subtree and the base of the one below.
struct BodyCut {
  int node = 0;   // index of the body in its own subtree
  int below = 0;  // index of the subtree below the body
  int row[6];     // indices of the six rows in the body's own subtree
};

/// A part of the trees between cuts. Constant data; nodes, coordinates and rows are in the island's order.
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

/// Cuts trees at each body that six rows fix to the world or a base, unless another body's row crosses. Linear cost.
BodySubtrees split_bodies(const Island& island, const BodyPattern& whole);

}  // namespace manycontact
