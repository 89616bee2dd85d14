#pragma once
// Advice on parts of a scene that are not needed at the state of the last solve. Each item consists of one or two
// sentences that contain names and no line breaks. All functions throw std::logic_error before a solve.

#include "manycontact/analysis/ranks.hpp"

namespace manycontact {

/// Lists redundant rows of J, single contacts that replace several, and contacts that constrain more directions than
/// their robots can move in. The ranks are those at the current configuration. `kinds` is the result of find_kinds.
std::vector<std::string> advise_on_contacts(const Scene& scene, const SceneData& data,
                                            const std::vector<IslandKind>& kinds);

/// Lists robots and joints that have no contact, velocity or acceleration, and bodies without mass. Accelerations below
/// 1e-9 of the scene's largest, or of gravity, count as zero.
std::vector<std::string> advise_on_bodies(const Scene& scene, const SceneData& data);

}  // namespace manycontact
