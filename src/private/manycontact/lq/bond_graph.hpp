#pragma once
// Which bonds meet at which cluster, in which knot, and where their w and mu stand in the Schur complement of
// bond_schur.hpp.

#include "manycontact/lq/block_cholesky.hpp"
#include "manycontact/lq/plan.hpp"

namespace manycontact::lq {

/// w or mu of one bond, as part of a cluster's y in a knot.
struct BondPart {
  int bond;
  bool is_w;
  int at, size;        // in the cluster's y of the knot
  int vertex, offset;  // in the Schur complement
};

/// A cluster in a knot.
struct BondNode {
  int cluster = 0;  // its index in the plan's knot
  std::vector<BondPart> parts;
  int size = 0;  // of y
};

/// Where a bond's w and mu stand: vertex and first row in it.
struct BondPlace {
  int w, w_offset, mu, mu_offset;
};

struct BondGraph {
  std::vector<std::vector<BondNode>> nodes;    // by cluster (as in knot 0), by knot
  std::vector<std::vector<BondPlace>> places;  // by knot, by bond
  /// In the order of elimination. Bonds of all knots that touch the same clusters share two vertices: all their mu (the
  /// even one, sign -1), then all their w (sign +1), knot by knot. Minimum degree (CAMD) on the graph of these pairs.
  std::vector<BlockCholesky::Vertex> vertices;
  std::vector<std::pair<int, int>> edges;
  std::vector<std::vector<int>> of_cluster;  // by cluster: the vertices its bonds are in, all of whose bonds touch it
};

/// The plan is one of Join::kNoBonds.
BondGraph make_bond_graph(const Problem& problem, const Plan& plan);

/// Operations of BondSchur::factorize.
double bond_schur_flops(const Problem& problem, const Plan& plan, const BondGraph& graph);

}  // namespace manycontact::lq
