#include "manycontact/kkt/bodies/pattern.hpp"

#include <algorithm>

#include "manycontact/kkt/costs.hpp"
#include "manycontact/sparse/tolerances.hpp"

namespace manycontact {

namespace {

void number_nodes(const Scene& scene, const Island& island, BodyPattern& p) {
  for (std::size_t k = 0; k < island.robots.size(); ++k) {
    const Model& model = *scene.robots[island.robots[k]].model;
    const int o = p.nodes;
    p.node_offset.push_back(o);
    for (int i = 0; i < model.njoints(); ++i) {
      const Joint& joint = model.joints[i];
      p.parent.push_back(joint.parent < 0 ? -1 : o + joint.parent);
      p.end.push_back(o + model.subtree_end[i]);
      p.first_dof.push_back(island.dof_offset[k] + joint.idx_v);
      p.ndof.push_back(joint.nv());
    }
    p.nodes += model.njoints();
  }
}

void number_rows(const Scene& scene, const Island& island, BodyPattern& p) {
  for (int c : island.contacts) {
    const Contact& contact = scene.contacts[c];
    p.A.insert(p.A.end(), contact.rows(), node_of(p, island, contact.A));
    p.B.insert(p.B.end(), contact.rows(), node_of(p, island, contact.B));
  }
}

void list_rows(BodyPattern& p) {
  std::vector<int> count(p.nodes + 1, 0);
  for (int row = 0; row < p.nc; ++row)
    for (int i : {p.A[row], p.B[row]})
      if (i >= 0) ++count[i + 1];
  for (int i = 0; i < p.nodes; ++i) count[i + 1] += count[i];
  p.at_first = count;
  p.at.resize(count[p.nodes]);
  for (int row = 0; row < p.nc; ++row)
    for (int i : {p.A[row], p.B[row]})
      if (i >= 0) p.at[count[i]++] = row;
}

void find_holds(BodyPattern& p) {
  p.hold.assign(p.nodes, -1);
  p.own_first.assign(1, 0);
  for (int i = 0; i < p.nodes; ++i) {
    if (p.end[i] == i + 1) continue;
    const std::size_t before = p.own.size();
    for (int q = p.at_first[i]; q < p.at_first[i + 1]; ++q)
      if (p.A[p.at[q]] < 0 || p.B[p.at[q]] < 0) p.own.push_back(p.at[q]);
    if (p.own.size() == before || p.own.size() - before > 6) {
      p.own.resize(before);
      continue;
    }
    p.hold[i] = static_cast<int>(p.own_first.size()) - 1;
    p.own_first.push_back(static_cast<int>(p.own.size()));
  }
}

// Numbers of rows, counted at the nodes where the rows end.
struct Ends {
  std::vector<int> arriving;  // one number per node: ends at the node of rows that are not complete there
  std::vector<int> alone;     // one number per node: rows whose only end on a node is there
  std::vector<int> meeting;   // one number per node: rows whose two ends meet there (BodyPattern::meeting)
};
Ends find_ends(const BodyPattern& p) {
  Ends ends{std::vector<int>(p.nodes), std::vector<int>(p.nodes), std::vector<int>(p.nodes)};
  for (int row = 0; row < p.nc; ++row) {
    if (p.A[row] < 0 || p.B[row] < 0) {
      if (const int i = std::max(p.A[row], p.B[row]); i >= 0) ++ends.alone[i];
      continue;
    }
    ++ends.arriving[p.A[row]], ++ends.arriving[p.B[row]];
    if (const int i = p.meeting(row); i >= 0) ends.meeting[i] += 1, ends.arriving[i] -= 2;
  }
  return ends;
}

// Estimates the rows open (not yet eliminated) at each node, for open_squared, open_updates and open_at_base.
void count_open(BodyPattern& p, Ends ends) {
  std::vector<double> left(p.nodes, 0);  // one number per node: complete rows that its children did not eliminate
  for (int i = p.nodes - 1; i >= 0; --i) {
    // Rows whose ends meet here are not counted, as they are eliminated at once: joints below move them.
    const double complete = left[i] + ends.alone[i];
    const double open = complete + ends.arriving[i] + ends.meeting[i];
    const double kept =
        std::clamp(complete - costs::kBodyEliminated * p.ndof[i], 0.0, static_cast<double>(tolerance::kMostOpen));
    p.open_squared += open * open;
    p.open_updates += open * open * (complete - kept + ends.meeting[i]);
    if (const int parent = p.parent[i]; parent >= 0)
      ends.arriving[parent] += ends.arriving[i], left[parent] += kept;
    else
      p.open_at_base += ends.arriving[i] + kept;
  }
}

// Computes how many rows may at most be open (not yet eliminated) at each node, and offsets of the memory for them.
void make_room(BodyPattern& p, Ends ends) {
  std::vector<int>& waiting = ends.arriving;
  std::vector<int> complete(p.nodes);
  int at_base = 0;
  for (int i = 0; i < p.nodes; ++i) complete[i] = ends.alone[i] + ends.meeting[i];
  // A row that is complete at a node is also counted for its ends, which only costs memory.
  p.most.resize(p.nodes);
  for (int i = p.nodes - 1; i >= 0; --i) {
    int own = 0;
    for (int k = p.at_first[i]; k < p.at_first[i + 1]; ++k) ++own;
    p.most[i] += own;
    const int open = std::min(complete[i], tolerance::kMostOpen);
    if (p.parent[i] >= 0) {
      const int parent = p.parent[i];
      waiting[parent] += waiting[i];
      complete[parent] += open;
      p.most[parent] += waiting[i] + open;
    } else {
      at_base += waiting[i] + open;
    }
  }
  p.most_at_base = at_base;
  const auto begin = [](auto& list) { list.assign(1, 0); };
  begin(p.row_first), begin(p.joint_first), begin(p.square_first), begin(p.D_first);
  for (int i = 0; i < p.nodes; ++i) {
    const std::size_t m = p.most[i], n = p.ndof[i];
    p.row_first.push_back(p.row_first.back() + m);
    p.joint_first.push_back(p.joint_first.back() + m * n);
    p.square_first.push_back(p.square_first.back() + m * m);
    p.D_first.push_back(p.D_first.back() + n * n);
  }
}

}  // namespace

int BodyPattern::meeting(int row) const {
  int i = A[row];
  while (i >= 0 && !complete(row, i)) i = parent[i];
  return i;
}

void BodyPattern::complete_analysis() {
  list_rows(*this);
  find_holds(*this);
  Ends ends = find_ends(*this);
  count_open(*this, ends);
  make_room(*this, std::move(ends));
}

BodyPattern analyze_bodies(const Scene& scene, const Island& island) {
  BodyPattern p;
  p.nv = island.nv;
  p.nc = island.nc;
  number_nodes(scene, island, p);
  number_rows(scene, island, p);
  p.complete_analysis();
  return p;
}

}  // namespace manycontact
