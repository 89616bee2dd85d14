#pragma once
// Bodies and contact rows of an island's body-space system (system.hpp), and the sizes of its factor.

#include <vector>

#include "manycontact/detail/kkt/island.hpp"

namespace manycontact {

/// Nodes are the joints' bodies, robot by robot, parents before children. Constant; shared by islands of one shape.
struct BodyPattern {
  int nodes = 0, nv = 0, nc = 0;
  std::vector<int> node_offset;      // one entry per robot of the island
  std::vector<int> parent, end;      // one entry per node: -1 at the base; one past its subtree
  std::vector<int> first_dof, ndof;  // one entry per node: first coordinate of its joint in the island, and number
  std::vector<int> A, B;             // one entry per contact row: the nodes it acts on; -1: fixed
  std::vector<int> at_first, at;     // rows on node i: at[at_first[i]] ... at[at_first[i + 1] - 1]

  // nodes with children that one to six rows constrain relative to the world or a base
  std::vector<int> hold;            // one entry per node: its index among these; -1: not one
  std::vector<int> own_first, own;  // rows of index h: own[own_first[h]] ... own[own_first[h + 1] - 1]

  // one entry per node: most rows open before its joint is eliminated; offsets of rows, rows x ndof, rows^2 numbers, D
  std::vector<int> most;
  std::vector<std::size_t> row_first, joint_first, square_first, D_first;
  int most_at_base = 0;  // rows left after all joints are eliminated
  // predicted cost of open rows: sums over nodes of number^2, of number^2 x eliminated; number left at the bases
  double open_squared = 0, open_updates = 0, open_at_base = 0;

  /// Whether both bodies of a row are in the subtree of node i, so that the row can be eliminated there.
  bool complete(int row, int i) const {
    const auto inside = [&](int node) { return node < 0 || (node >= i && node < end[i]); };
    return inside(A[row]) && inside(B[row]);
  }
  /// Returns the node at which a row's two ends meet; -1: none.
  int meeting(int row) const;
  /// Computes the remaining members, from `at_first` on, from the nodes and the ends of rows.
  void complete_analysis();
};

/// Analyses an island; linear in bodies, contacts, and rows times bodies between their two ends.
BodyPattern analyze_bodies(const Scene& scene, const Island& island);

/// Returns the node of an attachment; -1: fixed.
inline int node_of(const BodyPattern& pattern, const Island& island, const Attachment& at) {
  return moves(at) ? pattern.node_offset[local_robot(island, at.robot)] + at.joint : -1;
}

}  // namespace manycontact
