#include "manycontact/kkt/bodies/subtrees.hpp"

#include <algorithm>
#include <map>

namespace manycontact {

namespace {

bool is_held_by_six(const BodyPattern& p, int i) {
  return p.hold[i] >= 0 && p.own_first[p.hold[i] + 1] - p.own_first[p.hold[i]] == 6;
}

// Flags bodies at which trees can be cut: six rows constrain them, and no other row couples their subtree to others.
std::vector<char> find_cuts(const BodyPattern& p) {
  std::vector<char> cut(p.nodes, 0);
  for (int i = 0; i < p.nodes; ++i) cut[i] = is_held_by_six(p, i);
  for (int row = 0; row < p.nc; ++row) {
    if (p.A[row] < 0 || p.B[row] < 0) continue;
    const int end = p.meeting(row);
    for (int i : {p.A[row], p.B[row]})
      for (i = i == end ? i : p.parent[i]; i != end; i = p.parent[i]) cut[i] = 0;
    if (end >= 0 && (end == p.A[row] || end == p.B[row])) cut[end] = 0;
  }
  return cut;
}

// For each node of an island, its subtree and its number there; for each row, its number in its subtree.
struct NodeNumbers {
  std::vector<int> subtree, node, row;
};

// Assigns the nodes to subtrees, numbers them there, and lists the cuts between subtrees.
NodeNumbers number_subtrees(const BodyPattern& p, const std::vector<char>& cut, BodySubtrees& out) {
  NodeNumbers at{std::vector<int>(p.nodes), std::vector<int>(p.nodes), std::vector<int>(p.nc)};
  std::vector<int> below(p.nodes);
  std::vector<std::vector<BodyCut>> cuts(1);
  out.subtrees.resize(1);
  for (int i = 0; i < p.nodes; ++i) {
    const int subtree = at.subtree[i] = p.parent[i] < 0 ? 0 : below[p.parent[i]];
    at.node[i] = static_cast<int>(out.subtrees[subtree].node.size());
    out.subtrees[subtree].node.push_back(i);
    below[i] = subtree;
    if (!cut[i]) continue;
    below[i] = static_cast<int>(out.subtrees.size());
    cuts[subtree].push_back({at.node[i], below[i], {}});
    out.subtrees.emplace_back();
    cuts.emplace_back();
  }
  for (std::size_t k = 0; k < out.subtrees.size(); ++k) {
    out.subtrees[k].first_cut = static_cast<int>(out.cuts.size());
    for (const BodyCut& c : cuts[k]) {
      out.subtrees[c.below].above = static_cast<int>(out.cuts.size());
      out.cuts.push_back(c);
    }
    out.subtrees[k].end_cut = static_cast<int>(out.cuts.size());
  }
  return at;
}

// Calls use(row) for the rows of contact number `contact` of the island.
template <class Use>
void each_row(const Island& island, std::size_t contact, Use&& use) {
  const int end = contact + 1 < island.contacts.size() ? island.row_offset[contact + 1] : island.nc;
  for (int row = island.row_offset[contact]; row < end; ++row) use(row);
}

void number_contacts(const Island& island, const BodyPattern& p, NodeNumbers& at, BodySubtrees& out) {
  std::vector<int> rows(out.subtrees.size(), 0);
  for (std::size_t k = 0; k < island.contacts.size(); ++k) {
    const int first = island.row_offset[k], node = std::max(p.A[first], p.B[first]);
    const int subtree = node < 0 ? 0 : at.subtree[node];
    out.subtrees[subtree].contact.push_back(static_cast<int>(k));
    each_row(island, k, [&](int row) { at.row[row] = rows[subtree]++; });
  }
}

// Returns the pattern of a subtree, without the members that complete_analysis computes.
BodyPattern pattern_of(const BodyPattern& p, const Island& island, const NodeNumbers& at, const BodySubtree& subtree) {
  BodyPattern out;
  const int own = subtree.node.empty() ? -1 : at.subtree[subtree.node[0]];
  const auto local = [&](int node) { return node < 0 || at.subtree[node] != own ? -1 : at.node[node]; };
  out.nodes = static_cast<int>(subtree.node.size());
  for (int i : subtree.node) {
    out.parent.push_back(local(p.parent[i]));
    out.first_dof.push_back(out.nv);
    out.ndof.push_back(p.ndof[i]);
    out.nv += p.ndof[i];
  }
  out.end.resize(out.nodes);
  for (int i = out.nodes - 1; i >= 0; --i) {
    out.end[i] = std::max(out.end[i], i + 1);
    if (const int parent = out.parent[i]; parent >= 0) out.end[parent] = std::max(out.end[parent], out.end[i]);
  }
  for (int k : subtree.contact)
    each_row(island, static_cast<std::size_t>(k), [&](int row) {
      out.A.push_back(local(p.A[row]));
      out.B.push_back(local(p.B[row]));
    });
  out.nc = static_cast<int>(out.A.size());
  return out;
}

}  // namespace

bool may_be_cut(const BodyPattern& p) {
  for (int i = 0; i < p.nodes; ++i)
    if (is_held_by_six(p, i)) return true;
  return false;
}

BodySubtrees split_bodies(const Island& island, const BodyPattern& whole) {
  BodySubtrees out;
  NodeNumbers at = number_subtrees(whole, find_cuts(whole), out);
  number_contacts(island, whole, at, out);
  for (BodySubtree& subtree : out.subtrees)
    for (int c = subtree.first_cut; c < subtree.end_cut; ++c) {
      BodyCut& cut = out.cuts[c];
      const int hold = whole.hold[subtree.node[cut.node]];
      for (int k = 0; k < 6; ++k) cut.row[k] = at.row[whole.own[whole.own_first[hold] + k]];
    }
  std::map<std::vector<int>, int> shapes;
  std::vector<std::shared_ptr<const BodyPattern>> patterns;
  for (BodySubtree& subtree : out.subtrees) {
    BodyPattern p = pattern_of(whole, island, at, subtree);
    std::vector<int> key{p.nodes};  // the number of nodes determines the lengths of the lists in the key
    for (const std::vector<int>* list : {&p.parent, &p.ndof, &p.A, &p.B})
      key.insert(key.end(), list->begin(), list->end());
    const auto [found, is_new] = shapes.try_emplace(std::move(key), static_cast<int>(patterns.size()));
    if (is_new) {
      p.complete_analysis();
      patterns.push_back(std::make_shared<const BodyPattern>(std::move(p)));
    }
    subtree.shape = found->second;
    subtree.pattern = patterns[subtree.shape];
  }
  return out;
}

}  // namespace manycontact
