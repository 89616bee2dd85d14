#pragma once
// Lists each cluster's couplings, and the places of their variables y = (w, mu) in the matrix S of coupling_schur.hpp.

#include "manycontact/lq/block_cholesky.hpp"
#include "manycontact/lq/plan.hpp"

namespace manycontact::lq {

struct CouplingPart {  // the w or the mu of one coupling, as a part of the vector y of one cluster in one knot
  int coupling;
  bool is_w;
  int at, size;        // offset and size in the cluster's y of the knot
  int vertex, offset;  // vertex of the Schur complement S, and first row in this vertex
};

struct CouplingNode {  // The couplings of one cluster in one knot.
  int cluster = 0;     // index of the cluster in the plan of this knot
  std::vector<CouplingPart> parts;
  int size = 0;  // size of the cluster's y in the knot
};

/// The place of a coupling's w and mu in S, given by the vertex and the first row within this vertex.
struct CouplingPlace {
  int w, w_offset, mu, mu_offset;
};

struct CouplingGraph {
  std::vector<std::vector<CouplingNode>> nodes;    // indexed by cluster of knot 0, then by knot
  std::vector<std::vector<CouplingPlace>> places;  // indexed by knot, then by coupling
  /// Vertices in elimination order (CAMD, minimum degree). All couplings, in any knots, that connect the same clusters
  /// have one pair of vertices. The even one contains their mu (sign -1), the odd one their w (sign +1), knot by knot.
  std::vector<BlockCholesky::Vertex> vertices;
  std::vector<std::pair<int, int>> edges;
  std::vector<std::vector<int>>
      of_cluster;  // one entry per cluster: the vertices of the couplings that connect this cluster
};

/// Lists the couplings. The plan must be made with Join::kNoCouplings.
CouplingGraph make_coupling_graph(const Problem& problem, const Plan& plan);

double coupling_schur_flops(const Problem& problem, const Plan& plan, const CouplingGraph& graph);

}  // namespace manycontact::lq
