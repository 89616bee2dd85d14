#pragma once
// Bodies and contact rows of an island's body-space system (system.hpp), and the sizes of the system's factor.

#include <vector>

#include "manycontact/detail/kkt/island.hpp"

namespace manycontact {

/// The constant structure of an island's body-space system. Nodes are the joints' bodies, parents before children.
struct BodyPattern {
  int nodes = 0, nv = 0, nc = 0;
  std::vector<int> node_offset;      // one entry per robot of the island: number of its first node
  std::vector<int> parent, end;      // one entry per node: its parent, or -1; one past the last node of its subtree
  std::vector<int> first_dof, ndof;  // one entry per node: first coordinate of its joint, and their number
  std::vector<int> A, B;             // one entry per contact row: nodes on which it acts; -1: an immovable body
  std::vector<int> at_first, at;     // rows on node i: at[at_first[i]] ... at[at_first[i + 1] - 1]

  // Constrained nodes: nodes that have children, and are constrained by one to six rows to the world or a fixed base.
  std::vector<int> hold;            // one entry per node: its index h among constrained nodes, or -1
  std::vector<int> own_first, own;  // rows of constrained node h: own[own_first[h]] ... own[own_first[h + 1] - 1]

  // One entry per node: the largest number of rows that may be open (not yet eliminated) at it; offsets of these rows,
  // and of memory for rows x ndof numbers, for rows^2 numbers and for D^-1 (kkt/bodies/ldl.hpp).
  std::vector<int> most;
  std::vector<std::size_t> row_first, joint_first, square_first, D_first;
  int most_at_base = 0;  // rows that may be open after all joints are eliminated
  // Estimates for costs: sums over nodes of open rows^2 and of open rows^2 x eliminated rows; rows open at the bases.
  double open_squared = 0, open_updates = 0, open_at_base = 0;

  bool complete(int row, int i) const {  // whether both bodies are in the subtree of node i
    const auto inside = [&](int node) { return node < 0 || (node >= i && node < end[i]); };
    return inside(A[row]) && inside(B[row]);
  }
  int meeting(int row) const;  // lowest common ancestor of a row's nodes, or -1
  void complete_analysis();    // sets members after `B` from those before
};

/// Returns the pattern of an island, in time linear in bodies and contacts plus, for each row, the bodies between its
/// ends.
BodyPattern analyze_bodies(const Scene& scene, const Island& island);

/// Returns the node of an attachment, or -1 if it is immovable.
inline int node_of(const BodyPattern& pattern, const Island& island, const Attachment& at) {
  return moves(at) ? pattern.node_offset[local_robot(island, at.robot)] + at.joint : -1;
}

}  // namespace manycontact
