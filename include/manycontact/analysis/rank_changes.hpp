#pragma once
// Postures in which contact rows depend on each other that are independent beside them. With n a vector of rows with
// J^T n = 0, z a motion with J z = 0 and B(z, y) = n^T dJ[z] y, the change of J along z, the rank of J beside q is that
// at q, to first order, where B vanishes:
//
//     B(z, z) is not 0   the posture is singular: a loop lies flat, a leg is stretched. The rows that depend on each
//     other
//                        here hold one motion more beside it; a is that of this posture alone, no derivative exists
//     B(z, y) is not 0   for motions y that contacts do not allow: rows depend on each other only while loops are
//                        closed (Bennett's, Bricard's mechanisms). a is that of all states the mechanism comes to;
//                        derivatives along these exist, across them they do not
//
// J' v = dJ[v] v is what contact rows give at v, and B follows from it for z + y and z - y. Random n, z and y see it
// unless it vanishes for all.

#include <vector>

#include "manycontact/dynamics/data.hpp"

namespace manycontact {

struct RankChange {           // Of an island.
  std::size_t island = 0;     // its number
  bool singular = false;      // along motions that contacts allow; false: only where they are broken
  int rank = 0, rows = 0;     // at q
  std::vector<int> contacts;  // those whose rows depend on each other, ascending
  int coordinate = -1;  // of v: which the rows hold beside q and not here, most of all; -1: the island is too large
};

/// Islands whose rank changes at q (nq), that of the last solve. None where rows are independent, damping hides their
/// rank or the island failed. A few solves of the scene at rest. Throws std::logic_error before a solve.
std::vector<RankChange> rank_changes(const Scene& scene, const Eigen::Ref<const Eigen::VectorXd>& q,
                                     const SceneData& data);

}  // namespace manycontact
