#pragma once
#include <vector>

#include "manycontact/analysis/ranks.hpp"
#include "manycontact/sparse/tolerances.hpp"

namespace manycontact::internal {

/// The norm of each row of an island's J after projection on the complement of the independent rows before it, relative
/// to its size (rank/row_size.hpp).
struct RowRemainders {
  std::vector<double> left;             // empty where J is not in joint space
  double dependent = tolerance::kRank;  // rows with remainders up to this one depend on the rows before them;
                                        // it is chosen so that their number is what the solver has found
};
/// Uses dense Gram-Schmidt, twice. Call it after a solve and complete (dynamics/views.hpp).
RowRemainders row_remainders(const Scene& scene, const SceneData& data, std::size_t island);

/// Does what find_ranks does for an island. Call it after complete, which processes the whole scene.
IslandRanks ranks_of_island(const Scene& scene, const SceneData& data, std::size_t island);

}  // namespace manycontact::internal
