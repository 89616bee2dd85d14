#pragma once
// Scenes of the benchmarks: N humanoids, separate or hand in hand in a closed ring, feet held in 6D, state with noise.

#include <string>

#include "manycontact/analysis/load_scene.hpp"

namespace manycontact::bench {

/// The robot measured: "humanoid" (models/) or "talos" (../shared/robots, 38 dof; the figures of the peers are its).
bool talos_available();
SceneFile humanoids(int count, bool hand_in_hand);
SceneFile talos(int count);
/// Quadrupeds, each on four point feet, as in models/herd.xml.
SceneFile herd(int count);

}  // namespace manycontact::bench
