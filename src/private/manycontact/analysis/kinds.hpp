#pragma once
// Islands of which the same is to be said, so that a herd of a thousand takes one line.

#include "manycontact/analysis/ranks.hpp"

namespace manycontact {

/// Islands of one shape with the same ranks that the last solve answered alike (status, method, order, reason).
struct IslandKind {
  std::vector<int> islands;  // their numbers, ascending
  IslandRanks ranks;         // of the first
};

/// The islands' kinds, in the order of their first islands. After a solve; throws std::logic_error before.
std::vector<IslandKind> find_kinds(const Scene& scene, const SceneData& data);

/// Body pairs that are alike in their robots' models, joints, contact types and ranks: positions in `pairs`.
std::vector<std::vector<std::size_t>> alike_pairs(const Scene& scene, const std::vector<BodyPair>& pairs);

}  // namespace manycontact
