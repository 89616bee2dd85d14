#pragma once
// Islands with the same findings, so that a herd of a thousand takes one line.

#include "manycontact/analysis/ranks.hpp"

namespace manycontact {

/// Islands of one shape with the same ranks, and with the same status, method, order and reason in the last solve.
struct IslandKind {
  std::vector<int> islands;  // numbers of the islands, ascending
  IslandRanks ranks;         // ranks of the first island
};

/// The islands' kinds, in the order of their first islands. After a solve; throws std::logic_error before.
std::vector<IslandKind> find_kinds(const Scene& scene, const SceneData& data);

/// Body pairs with the same models, joints, contact types and ranks: positions in `pairs`.
std::vector<std::vector<std::size_t>> alike_pairs(const Scene& scene, const std::vector<BodyPair>& pairs);

}  // namespace manycontact
