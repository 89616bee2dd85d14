#pragma once
// The bodies and contact rows that an island's body-space system (system.hpp) joins, and the memory its factor needs.

#include <vector>

#include "manycontact/detail/kkt/island.hpp"

namespace manycontact {

/// Nodes are the joints' bodies, robot after robot, parents before children. Constant; shared by islands of one shape.
struct BodyPattern {
  int nodes = 0, nv = 0, nc = 0;
  std::vector<int> node_offset;      // one entry per robot of the island
  std::vector<int> parent, end;      // one entry per node: -1 at the base; one past its subtree
  std::vector<int> first_dof, ndof;  // one entry per node: its joint's coordinates in the island
  std::vector<int> A, B;             // one entry per contact row: the nodes it acts on, -1 for what does not move
  std::vector<int> at_first, at;     // rows that act on a node: at[at_first[i]] ... at[at_first[i + 1] - 1]

  // nodes with children that one to six rows constrain relative to the world or a base
  std::vector<int> hold;            // one entry per node: its number among them, -1: not one
  std::vector<int> own_first, own;  // the rows of the h-th: own[own_first[h]] ... own[own_first[h + 1] - 1]

  // rows that may be open at a node before its joint is eliminated, and where its numbers begin: of rows, of rows
  // times coordinates, of rows times rows; the joint's D
  std::vector<int> most;
  std::vector<std::size_t> row_first, joint_first, square_first, D_first;
  int most_at_base = 0;  // rows left when all joints are eliminated
  // predicted cost of rows that are not yet eliminated: the sum over nodes of their number squared, and of that times
  // the number eliminated there; the number of rows left at the bases
  double open_squared = 0, open_updates = 0, open_at_base = 0;

  /// Whether both bodies of a row are in the subtree of node i, so that the row can be eliminated from node i on.
  bool complete(int row, int i) const {
    const auto inside = [&](int node) { return node < 0 || (node >= i && node < end[i]); };
    return inside(A[row]) && inside(B[row]);
  }
  /// The node at which a row's two ends meet, -1: none.
  int meeting(int row) const;
  /// Computes the remaining members, from `at_first` on, from the nodes and the ends of rows.
  void complete_analysis();
};

/// Cost linear in bodies, contacts, and rows times the bodies between the two ends of one.
BodyPattern analyze_bodies(const Scene& scene, const Island& island);

/// The node that an attachment is on; -1 where it does not move.
inline int node_of(const BodyPattern& pattern, const Island& island, const Attachment& at) {
  return moves(at) ? pattern.node_offset[local_robot(island, at.robot)] + at.joint : -1;
}

}  // namespace manycontact
