#pragma once
// Trees cut at constrained bodies. Six independent rows between a body and what does not move determine its
// acceleration, so the subtree below it is a system (system.hpp) of its own, whose base has a prescribed motion. It
// exerts a reaction on the body, which these rows' forces alone balance.

#include <memory>

#include "manycontact/kkt/bodies/pattern.hpp"

namespace manycontact {

/// A body that six rows constrain, a leaf in its own subtree.
struct BodyCut {
  int node = 0;   // number in its own subtree
  int below = 0;  // the subtree that hangs on it
  int row[6];     // numbers in its own subtree
};

/// Constant; its nodes, coordinates and rows are numbered in the order of the island's.
struct BodySubtree {
  std::shared_ptr<const BodyPattern> pattern;  // subtrees of one shape share one
  int shape = 0;                               // number of its pattern among all
  int above = -1;                              // the cut that its bases are attached to; -1: none
  std::vector<int> node, contact;              // numbers in the island
  int first_cut = 0, end_cut = 0;              // cuts in this subtree
};

struct BodySubtrees {
  std::vector<BodySubtree> subtrees;  // each after the one that it hangs on
  std::vector<BodyCut> cuts;
};

/// Whether there is a body to cut at: one with children that is constrained by six rows.
bool may_be_cut(const BodyPattern& p);

/// Cuts at each body that six rows fix to the world or a base, unless a row of another body crosses it. The cost is
/// linear, as that of analyze_bodies.
BodySubtrees split_bodies(const Island& island, const BodyPattern& whole);

}  // namespace manycontact
