#pragma once
// Detects configurations at which J loses rank: constraint rows are dependent there, but independent at neighbouring
// configurations. Let n be a vector with J^T n = 0, z a motion with J z = 0, and dJ[z] the change of J along z. If B(z,
// y) = n^T dJ[z] y vanishes for all n, z and all motions y, the rank is locally constant to first order. Otherwise:
//
//     B(z, z) is not 0   The configuration is singular, as in a flat loop or a stretched leg. The dependent rows
//                        constrain one more motion at neighbouring q. The accelerations are valid for this
//                        configuration alone, and no derivative exists.
//     B(z, y) is not 0   for a motion y that violates the contacts. Rows are dependent only while loops are closed, as
//                        in Bennett's and Bricard's mechanisms. The accelerations are valid for all reachable states.
//                        Derivatives exist along reachable states, but not across them.
//
// B follows from the bias acceleration dJ[v] v of the constraint rows at the velocities v = z + y and v = z - y. Random
// n, z and y detect a change unless B vanishes for all of them.

#include <vector>

#include "manycontact/dynamics/data.hpp"

namespace manycontact {

struct RankChange {  // A change of rank of an island.
  std::size_t island = 0;
  bool singular = false;      // the rank changes along motions that the contacts allow (false: only along violations)
  int rank = 0, rows = 0;     // rank and number of the island's rows at q
  std::vector<int> contacts;  // the contacts with dependent rows, ascending
  int coordinate = -1;  // the coordinate of v that the rows constrain most at neighbouring configurations but not here;
                        // -1: the island is too large
};

/// Lists the islands whose rank changes at q (nq), the configuration of the last solve, except islands with independent
/// rows, damping, or a failed solve. Costs a few solves of the scene at rest. Throws std::logic_error before a solve.
std::vector<RankChange> rank_changes(const Scene& scene, const ConstVectorRef& q, const SceneData& data);

}  // namespace manycontact
