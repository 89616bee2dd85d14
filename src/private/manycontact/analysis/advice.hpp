#pragma once
// What a scene models more than it needs, at the state solved last. One item per sentence or two, in plain words:
// names, no line breaks, nothing for a terminal. All throw std::logic_error before a solve.

#include "manycontact/analysis/kinds.hpp"

namespace manycontact {

/// Rows of J that are redundant, single contacts that hold the same as several, contacts that hold more directions than
/// their robots can move in. Only what follows from ranks at this configuration. kinds: by find_kinds, of these data.
std::vector<std::string> advise_on_contacts(const Scene& scene, const SceneData& data,
                                            const std::vector<IslandKind>& kinds);

/// Robots and joints that nothing loads or moves (accelerations below 1e-9 of the scene's largest, or of gravity, count
/// as none), and bodies without mass.
std::vector<std::string> advise_on_bodies(const Scene& scene, const SceneData& data);

}  // namespace manycontact
