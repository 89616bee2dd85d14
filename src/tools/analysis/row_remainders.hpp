#pragma once
#include <vector>

#include "manycontact/analysis/ranks.hpp"
#include "manycontact/sparse/tolerances.hpp"

namespace manycontact::internal {

/// Per row of an island's J, its norm after projection on the complement of the independent rows before it, relative to
/// its size (rank/row_size.hpp).
struct RowRemainders {
  std::vector<double> left;             // empty where J is not in joint space
  double dependent = tolerance::kRank;  // rows with remainders up to this one depend on the rows before them, so that
                                        // as many count as the solver has found
};
/// Dense, by Gram and Schmidt, twice. After a solve and complete (dynamics/views.hpp).
RowRemainders row_remainders(const Scene& scene, const SceneData& data, std::size_t island);

/// find_ranks of an island after complete, which goes over the whole scene.
IslandRanks ranks_of_island(const Scene& scene, const SceneData& data, std::size_t island);

}  // namespace manycontact::internal
