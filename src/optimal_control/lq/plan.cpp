#include "manycontact/lq/plan.hpp"

#include <algorithm>

#include "manycontact/sparse/union_find.hpp"

namespace manycontact::lq {
namespace {

void join_knot(const Problem& problem, const Knot& knot, Join join, sparse::UnionFind& partition) {
  if (join == Join::kAll)
    for (int i = 1; i < problem.blocks(); ++i) partition.join(0, i);
  std::vector<int> first(knot.couplings.size(), -1);  // one block that each coupling connects, or -1
  for (const Group& g : knot.groups) {
    for (int i : g.blocks) partition.join(g.blocks.front(), i);
    if (join != Join::kIslands) continue;
    for (int b : g.couplings) {
      if (first[b] >= 0) partition.join(first[b], g.blocks.front());
      first[b] = g.blocks.front();
    }
  }
}

// Appends the states and the controls of group `index` to the cluster.
void add_member(const Problem& problem, int k, int index, Cluster& c) {
  const Group& g = problem.knots[k].groups[index];
  Member m{index, c.nx, 0, {}, {}};
  const int u = c.nu;
  for (int i : g.blocks) {
    c.blocks.push_back(i);
    c.x_start.push_back(c.nx);
    c.u_start.push_back(c.nu);
    c.nx += problem.nx[i];
    if (k < problem.horizon()) c.nu += problem.nu[i];
  }
  m.nx = c.nx - m.x;
  m.v.push_back({0, c.nu - u, u});
  c.members.push_back(std::move(m));
}

// Adds the couplings of the members to the cluster. Their w follow the controls of all members in v.
void add_couplings(const Knot& knot, Cluster& c) {
  std::vector<int> w(knot.couplings.size(), -1), row(knot.couplings.size(), -1);
  for (Member& m : c.members) {
    int from_v = m.v.front().size, from_row = 0;
    for (int b : knot.groups[m.group].couplings) {
      const Coupling& coupling = knot.couplings[b];
      if (w[b] < 0) {
        w[b] = c.nv;
        row[b] = c.rows;
        c.couplings.push_back(b);
        c.w_start.push_back(c.nv);
        c.row_start.push_back(c.rows);
        c.nv += coupling.size;
        c.rows += coupling.rows;
      }
      m.v.push_back({from_v, coupling.size, w[b]});
      m.rows.push_back({from_row, coupling.rows, row[b]});
      from_v += coupling.size;
      from_row += coupling.rows;
    }
  }
}

std::vector<Cluster> clusters_of(const Problem& problem, int k, Join join, sparse::UnionFind& partition) {
  const Knot& knot = problem.knots[k];
  std::vector<Cluster> clusters;
  std::vector<int> index(problem.blocks(), -1);  // cluster of each root of the partition, or -1
  for (int g = 0; g < static_cast<int>(knot.groups.size()); ++g) {
    int& c = index[partition.root(knot.groups[g].blocks.front())];
    if (c < 0) {
      c = static_cast<int>(clusters.size());
      clusters.emplace_back();
    }
    add_member(problem, k, g, clusters[c]);
  }
  for (Cluster& c : clusters) {
    c.nv = c.nu;
    if (join != Join::kNoCouplings) add_couplings(knot, c);
  }
  return clusters;
}

void link(std::vector<Cluster>& now, const std::vector<Cluster>& next, int blocks) {
  std::vector<int> owner(blocks);
  for (std::size_t c = 0; c < next.size(); ++c)
    for (int i : next[c].blocks) owner[i] = static_cast<int>(c);
  for (Cluster& c : now) {
    for (int i : c.blocks)
      if (std::find(c.next.begin(), c.next.end(), owner[i]) == c.next.end()) c.next.push_back(owner[i]);
    c.next_in_order = c.next.size() == 1 && next[c.next[0]].blocks == c.blocks;
  }
}

}  // namespace

Plan make_plan(const Problem& problem, Join join) {
  std::vector<int> memory(problem.blocks());
  sparse::UnionFind partition(memory);  // sets of blocks, from the last knot to the first; sets are only joined
  if (join == Join::kNoCouplings)
    for (const Knot& knot : problem.knots) join_knot(problem, knot, join, partition);
  const int T = problem.horizon();
  Plan plan(T + 1);
  for (int k = T; k >= 0; --k) {
    join_knot(problem, problem.knots[k], join, partition);
    plan[k] = clusters_of(problem, k, join, partition);
    if (k < T) link(plan[k], plan[k + 1], problem.blocks());
  }
  return plan;
}

double riccati_flops(const Problem& problem, const Plan& plan) {
  double flops = 0;
  for (int k = 0; k < problem.horizon(); ++k)
    for (const Cluster& c : plan[k]) {
      const double n = c.nx, m = c.nv, e = c.nv + c.rows;
      for (const Member& member : c.members) {
        const double ng = member.nx;
        double mg = 0;
        for (const Piece& p : member.v) mg += p.size;
        flops += 2 * n * ng * ng + n * ng * ng     // operations for P A and A^T P A
                 + 2 * n * ng * mg                 // operations for P B
                 + 2 * ng * ng * m + ng * mg * m;  // operations for A^T P B and B^T P B
      }
      flops += c.rows > 0 || c.nv > c.nu ? 2 * e * e * e / 3 + 2 * e * e * n : m * m * m / 3 + 2 * m * m * n;
      flops += n * n * e;  // P = Qxx + Qxv K
    }
  return flops;
}

}  // namespace manycontact::lq
