#pragma once
// The plan of a recursion: the blocks whose value functions form one matrix, in each knot.

#include <vector>

#include "manycontact/lq/problem.hpp"

namespace manycontact::lq {

/// A part of a group's vector, and its offset in that of its cluster.
struct Piece {
  int from, size, to;
};

struct Member {
  int group;
  int x, nx;                // first index of its states in the cluster's x, and their number
  std::vector<Piece> v;     // u, and w of the couplings within the cluster
  std::vector<Piece> rows;  // equations of the couplings within the cluster
};

/// Blocks joined in this knot or later: the value function's block. Its states are its members' one after the other,
/// its controls v the members' u, then the w of its couplings.
struct Cluster {
  std::vector<int> blocks;   // listed in the order of the members
  std::vector<int> x_start;  // start of each block in the cluster's x
  std::vector<int> u_start;  // start of each block in the cluster's u
  std::vector<Member> members;
  std::vector<int> couplings;  // within the cluster: eliminated with the controls
  std::vector<int> w_start;    // start of each coupling's w in v
  std::vector<int> row_start;
  std::vector<int> next;       // clusters of the next knot that compose this one
  bool next_in_order = false;  // one cluster, with the same blocks in the same order
  int nx = 0, nu = 0, nv = 0, rows = 0;
};

enum class Join {
  kAll,          // one cluster: dense
  kIslands,      // one cluster per set of blocks that groups and couplings join in the knot or later
  kNoCouplings,  // one cluster per set of blocks that groups join in any knot; couplings stay between clusters
};

using Plan = std::vector<std::vector<Cluster>>;  // one entry per knot
Plan make_plan(const Problem& problem, Join join);

/// Returns the number of operations of the Riccati recursion over the plan.
double riccati_flops(const Problem& problem, const Plan& plan);

}  // namespace manycontact::lq
