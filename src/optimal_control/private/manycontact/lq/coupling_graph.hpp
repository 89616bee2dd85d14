#pragma once
// Relates couplings to clusters: those on each cluster in each knot, and offsets of w, mu in coupling_schur.hpp's S.

#include "manycontact/lq/block_cholesky.hpp"
#include "manycontact/lq/plan.hpp"

namespace manycontact::lq {

/// w or mu of one coupling, as part of a cluster's y in a knot.
struct CouplingPart {
  int coupling;
  bool is_w;
  int at, size;        // offset and size in the cluster's y of the knot
  int vertex, offset;  // place in the Schur complement
};

struct CouplingNode {
  int cluster = 0;  // index of the cluster in the plan's knot
  std::vector<CouplingPart> parts;
  int size = 0;  // size of y
};

/// Place of a coupling's w and mu: vertex and first row in it.
struct CouplingPlace {
  int w, w_offset, mu, mu_offset;
};

struct CouplingGraph {
  std::vector<std::vector<CouplingNode>> nodes;    // indexed by cluster of knot 0, then by knot
  std::vector<std::vector<CouplingPlace>> places;  // indexed by knot, then by coupling
  /// Vertices in elimination order. Couplings that touch the same clusters in any knot share two: all their mu (even,
  /// sign -1), then all their w (sign +1), knot by knot. Minimum degree (CAMD) on the graph of pairs orders them.
  std::vector<BlockCholesky::Vertex> vertices;
  std::vector<std::pair<int, int>> edges;
  std::vector<std::vector<int>>
      of_cluster;  // one entry per cluster: the vertices of its couplings; every coupling in them touches it
};

/// plan: made with Join::kNoCouplings.
CouplingGraph make_coupling_graph(const Problem& problem, const Plan& plan);

/// Returns the number of operations of CouplingSchur::factorize.
double coupling_schur_flops(const Problem& problem, const Plan& plan, const CouplingGraph& graph);

}  // namespace manycontact::lq
