#pragma once
#include <vector>

#include "manycontact/analysis/ranks.hpp"
#include "manycontact/sparse/tolerances.hpp"

namespace manycontact::internal {

/// Per row of an island's J, what the rows before it that count leave of it, of its own size (rank/row_size.hpp);
/// up to tolerance::kRank it counts for nothing. Dense, by Gram and Schmidt, twice. After a solve and complete
/// (dynamics/views.hpp); empty where J is not in joint space.
std::vector<double> row_remainders(const Scene& scene, const SceneData& data, std::size_t island);

/// find_ranks of an island after complete, which goes over the whole scene.
IslandRanks ranks_of_island(const Scene& scene, const SceneData& data, std::size_t island);

}  // namespace manycontact::internal
