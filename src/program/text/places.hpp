#pragma once
#include <vector>

#include "manycontact/detail/kkt/island.hpp"

namespace manycontact::cli {

/// Indices in the scene of an island's velocities, torques and rows of active contacts, in the order of the island.
struct Places {
  std::vector<int> v, u, f;

  Places(const Scene& scene, const std::vector<int>& f_offset, const Island& island) {
    const auto into = [](std::vector<int>& places) {
      return [&places](int first, int, int count) {
        for (int i = 0; i < count; ++i) places.push_back(first + i);
      };
    };
    each_velocity_block(scene, island, into(v));
    each_torque_block(scene, island, into(u));
    each_force_block(scene, f_offset, island, into(f));
  }
};

}  // namespace manycontact::cli
