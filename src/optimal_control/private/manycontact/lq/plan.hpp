#pragma once
// The plan of a Riccati recursion: for each knot, the sets of blocks (clusters) that have a common value function.

#include <vector>

#include "manycontact/lq/problem.hpp"

namespace manycontact::lq {

/// A part of a vector of a group. It begins at `from` in this vector, and at `to` in the vector of the cluster.
struct Piece {
  int from, size, to;
};

struct Member {  // A group of a cluster.
  int group;
  int x, nx;                // first index of the group's states in the cluster's x, and number of these states
  std::vector<Piece> v;     // u, and w of the couplings within the cluster
  std::vector<Piece> rows;  // equations of the couplings within the cluster
};

/// A set of blocks that are joined in this knot or later, and have a common value function. Its state stacks the
/// members' states; its controls v are the members' u, then the w of the couplings within it.
struct Cluster {
  std::vector<int> blocks;   // listed in the order of the members
  std::vector<int> x_start;  // start of each block in the cluster's x
  std::vector<int> u_start;  // start of each block in the cluster's u
  std::vector<Member> members;
  std::vector<int> couplings;  // couplings within the cluster, which are eliminated with the controls
  std::vector<int> w_start;    // start of each coupling's w in v
  std::vector<int> row_start;
  std::vector<int> next;       // clusters of the next knot that have the same blocks together
  bool next_in_order = false;  // whether `next` is one cluster, with the blocks in the same order
  int nx = 0, nu = 0, nv = 0, rows = 0;
};

enum class Join {
  kAll,          // one cluster of all blocks: a dense recursion
  kIslands,      // one cluster per set of blocks that groups and couplings join in the knot or later
  kNoCouplings,  // one cluster per set of blocks that groups join in any knot; couplings connect clusters
};

using Plan = std::vector<std::vector<Cluster>>;  // one entry per knot
Plan make_plan(const Problem& problem, Join join);

double riccati_flops(const Problem& problem, const Plan& plan);

}  // namespace manycontact::lq
