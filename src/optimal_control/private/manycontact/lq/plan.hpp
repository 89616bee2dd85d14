#pragma once
// Which blocks' value functions are one matrix, in each knot.

#include <vector>

#include "manycontact/lq/problem.hpp"

namespace manycontact::lq {

/// A part of a group's vector, and its offset in that of its cluster.
struct Piece {
  int from, size, to;
};

/// A group of a cluster.
struct Member {
  int group;
  int x, nx;                // where its states begin in the cluster's, and how many they are
  std::vector<Piece> v;     // u, and w of the couplings within the cluster
  std::vector<Piece> rows;  // of the couplings within the cluster
};

/// Blocks joined in this knot or later: the value function's block. Its states are its members' one after the other,
/// its controls v the members' u, then the w of its couplings.
struct Cluster {
  std::vector<int> blocks;   // in the order of the members
  std::vector<int> x_start;  // of each block in the cluster's x
  std::vector<int> u_start;  // of each block in the cluster's u
  std::vector<Member> members;
  std::vector<int> couplings;  // within the cluster: eliminated with the controls
  std::vector<int> w_start;    // of each, in v
  std::vector<int> row_start;
  std::vector<int> next;       // clusters of the next knot that it is made of
  bool next_in_order = false;  // one cluster, with the same blocks in the same order
  int nx = 0, nu = 0, nv = 0, rows = 0;
};

enum class Join {
  kAll,          // one cluster: dense
  kIslands,      // what groups and couplings join in the knot or later
  kNoCouplings,  // what groups join in any knot; couplings stay between the clusters
};

using Plan = std::vector<std::vector<Cluster>>;  // by knot
Plan make_plan(const Problem& problem, Join join);

/// Operations of the Riccati recursion over the plan.
double riccati_flops(const Problem& problem, const Plan& plan);

}  // namespace manycontact::lq
