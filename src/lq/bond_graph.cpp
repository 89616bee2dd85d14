#include "manycontact/lq/bond_graph.hpp"

#include <algorithm>
#include <map>
#include <set>

#include "manycontact/lq/block_cholesky.hpp"
#include "manycontact/sparse/ordering.hpp"

namespace manycontact::lq {
namespace {

// By cluster of knot 0, which the plan keeps: its index and its bonds in each knot.
void make_nodes(const Problem& problem, const Plan& plan, BondGraph& graph) {
  graph.nodes.assign(plan[0].size(), std::vector<BondNode>(plan.size()));
  for (std::size_t c = 0; c < plan[0].size(); ++c) {
    int index = static_cast<int>(c);
    for (std::size_t k = 0; k < plan.size(); ++k) {
      BondNode& node = graph.nodes[c][k];
      node.cluster = index;
      std::set<int> bonds;
      for (const Member& m : plan[k][index].members) {
        const Group& g = problem.knots[k].groups[m.group];
        bonds.insert(g.bonds.begin(), g.bonds.end());
      }
      for (const bool is_w : {true, false})
        for (int b : bonds) {
          const Bond& bond = problem.knots[k].bonds[b];
          const int size = is_w ? bond.size : bond.rows;
          if (size == 0) continue;
          node.parts.push_back({b, is_w, node.size, size, -1, 0});
          node.size += size;
        }
      if (k + 1 < plan.size()) index = plan[k][index].next[0];
    }
  }
}

// Bonds of all knots that touch the same clusters are one track, of two vertices in S: all their mu, then all their w.
void make_vertices(const Problem& problem, BondGraph& graph) {
  const int T = problem.horizon();
  std::vector<std::vector<std::vector<int>>> touched(T + 1);  // by knot, by bond: clusters
  for (int k = 0; k <= T; ++k) {
    touched[k].resize(problem.knots[k].bonds.size());
    for (std::size_t c = 0; c < graph.nodes.size(); ++c)
      for (const BondPart& part : graph.nodes[c][k].parts) {
        std::vector<int>& of_bond = touched[k][part.bond];
        if (of_bond.empty() || of_bond.back() != static_cast<int>(c)) of_bond.push_back(static_cast<int>(c));
      }
  }
  std::map<std::vector<int>, int> tracks;
  for (const auto& knot : touched)
    for (const auto& clusters : knot) tracks.emplace(clusters, static_cast<int>(tracks.size()));

  std::vector<std::pair<int, int>> edges;  // tracks that share a cluster
  for (std::size_t c = 0; c < graph.nodes.size(); ++c) {
    std::vector<int> mine;
    for (const auto& [clusters, track] : tracks)
      if (std::find(clusters.begin(), clusters.end(), static_cast<int>(c)) != clusters.end()) mine.push_back(track);
    for (int a : mine)
      for (int b : mine) edges.push_back({a, b});
  }
  const int count = static_cast<int>(tracks.size());
  const std::vector<int> order = sparse::camd_order(sparse::make_pattern(count, edges), {});
  const std::vector<int> position = sparse::inverse(order);

  std::vector<BlockCholesky::Vertex>& vertices = graph.vertices;
  for (int t = 0; t < count; ++t) vertices.insert(vertices.end(), {{0, -1.}, {0, 1.}});
  graph.places.assign(T + 1, {});
  for (int k = 0; k <= T; ++k)
    for (std::size_t b = 0; b < touched[k].size(); ++b) {
      const int v = 2 * position[tracks.at(touched[k][b])];
      const Bond& bond = problem.knots[k].bonds[b];
      graph.places[k].push_back({v + 1, vertices[v + 1].size, v, vertices[v].size});
      vertices[v].size += bond.rows;
      vertices[v + 1].size += bond.size;
    }
  for (auto& cluster : graph.nodes) {
    std::set<int> mine;
    for (int k = 0; k <= T; ++k)
      for (BondPart& part : cluster[k].parts) {
        const BondPlace& place = graph.places[k][part.bond];
        part.vertex = part.is_w ? place.w : place.mu;
        part.offset = part.is_w ? place.w_offset : place.mu_offset;
        mine.insert(part.vertex);
      }
    graph.of_cluster.emplace_back(mine.begin(), mine.end());
  }
  std::vector<std::pair<int, int>>& blocks = graph.edges;
  for (const auto& [a, b] : edges)
    for (int i : {0, 1})
      for (int j : {0, 1}) blocks.push_back({2 * position[a] + i, 2 * position[b] + j});
  for (int t = 0; t < count; ++t) blocks.push_back({2 * t, 2 * t + 1});
}

}  // namespace

BondGraph make_bond_graph(const Problem& problem, const Plan& plan) {
  BondGraph graph;
  make_nodes(problem, plan, graph);
  make_vertices(problem, graph);
  return graph;
}

double bond_schur_flops(const Problem& problem, const Plan& plan, const BondGraph& graph) {
  double flops = riccati_flops(problem, plan) + block_cholesky_flops(graph.vertices, graph.edges);
  for (const auto& cluster : graph.nodes) {
    double later = 0;  // y of the knots behind
    for (std::size_t k = plan.size(); k-- > 0;) {
      const Cluster& c = plan[k][cluster[k].cluster];
      const double n = c.nx, m = c.nu, y = cluster[k].size;
      flops += 3 * n * n * n + 2 * n * n * m + n * m * (n + m)   // F, W
               + 10 * n * n * y + 6 * n * m * y + 4 * n * y * y  // pi, theta, S_ll
               + 2 * n * later * (n + y);                        // F^T V, theta^T V
      later += y;
    }
  }
  return flops;
}

}  // namespace manycontact::lq
