#include "manycontact/lq/coupling_graph.hpp"

#include <algorithm>
#include <map>
#include <set>

#include "manycontact/lq/block_cholesky.hpp"
#include "manycontact/sparse/ordering.hpp"

namespace manycontact::lq {
namespace {

// Sets index and couplings of each cluster in each knot. With kNoCouplings all knots have the same clusters.
void make_nodes(const Problem& problem, const Plan& plan, CouplingGraph& graph) {
  graph.nodes.assign(plan[0].size(), std::vector<CouplingNode>(plan.size()));
  for (std::size_t c = 0; c < plan[0].size(); ++c) {
    int index = static_cast<int>(c);
    for (std::size_t k = 0; k < plan.size(); ++k) {
      CouplingNode& node = graph.nodes[c][k];
      node.cluster = index;
      std::set<int> couplings;
      for (const Member& m : plan[k][index].members) {
        const Group& g = problem.knots[k].groups[m.group];
        couplings.insert(g.couplings.begin(), g.couplings.end());
      }
      for (const bool is_w : {true, false})
        for (int b : couplings) {
          const Coupling& coupling = problem.knots[k].couplings[b];
          const int size = is_w ? coupling.size : coupling.rows;
          if (size == 0) continue;
          node.parts.push_back({b, is_w, node.size, size, -1, 0});
          node.size += size;
        }
      if (k + 1 < plan.size()) index = plan[k][index].next[0];
    }
  }
}

// Makes two vertices of S for each track, one for all its mu and one for all its w. A track is the set of couplings of
// any knots that connect the same clusters.
void make_vertices(const Problem& problem, CouplingGraph& graph) {
  const int T = problem.horizon();
  std::vector<std::vector<std::vector<int>>> touched(T + 1);  // clusters of each coupling, per knot
  for (int k = 0; k <= T; ++k) {
    touched[k].resize(problem.knots[k].couplings.size());
    for (std::size_t c = 0; c < graph.nodes.size(); ++c)
      for (const CouplingPart& part : graph.nodes[c][k].parts) {
        std::vector<int>& of_coupling = touched[k][part.coupling];
        if (of_coupling.empty() || of_coupling.back() != static_cast<int>(c))
          of_coupling.push_back(static_cast<int>(c));
      }
  }
  std::map<std::vector<int>, int> tracks;
  for (const auto& knot : touched)
    for (const auto& clusters : knot) tracks.emplace(clusters, static_cast<int>(tracks.size()));

  std::vector<std::pair<int, int>> edges;  // pairs of tracks that share a cluster
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
      const Coupling& coupling = problem.knots[k].couplings[b];
      graph.places[k].push_back({v + 1, vertices[v + 1].size, v, vertices[v].size});
      vertices[v].size += coupling.rows;
      vertices[v + 1].size += coupling.size;
    }
  for (auto& cluster : graph.nodes) {
    std::set<int> mine;
    for (int k = 0; k <= T; ++k)
      for (CouplingPart& part : cluster[k].parts) {
        const CouplingPlace& place = graph.places[k][part.coupling];
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

CouplingGraph make_coupling_graph(const Problem& problem, const Plan& plan) {
  CouplingGraph graph;
  make_nodes(problem, plan, graph);
  make_vertices(problem, graph);
  return graph;
}

double coupling_schur_flops(const Problem& problem, const Plan& plan, const CouplingGraph& graph) {
  double flops = riccati_flops(problem, plan) + block_cholesky_flops(graph.vertices, graph.edges);
  for (const auto& cluster : graph.nodes) {
    double later = 0;  // sum of the sizes of y in later knots
    for (std::size_t k = plan.size(); k-- > 0;) {
      const Cluster& c = plan[k][cluster[k].cluster];
      const double n = c.nx, m = c.nu, y = cluster[k].size;
      flops += 3 * n * n * n + 2 * n * n * m + n * m * (n + m)   // operations for F and W
               + 10 * n * n * y + 6 * n * m * y + 4 * n * y * y  // operations for pi, theta and S_ll
               + 2 * n * later * (n + y);                        // operations for F^T V and theta^T V
      later += y;
    }
  }
  return flops;
}

}  // namespace manycontact::lq
