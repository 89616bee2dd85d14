#pragma once
// The islands of a scene as tests count them, independent of any method.

#include "manycontact/detail/kkt/island.hpp"
#include "manycontact/dynamics/data.hpp"

namespace manycontact::test {

inline std::vector<Island> islands_at(const Scene& scene, const SceneData& data) {
  return find_islands(scene, data.active);
}

/// Returns for each robot the number of its island.
inline std::vector<int> island_numbers(const Scene& scene, const std::vector<char>& active) {
  std::vector<int> number(scene.robots.size());
  const std::vector<Island> islands = find_islands(scene, active);
  for (std::size_t i = 0; i < islands.size(); ++i)
    for (int r : islands[i].robots) number[r] = static_cast<int>(i);
  return number;
}

}  // namespace manycontact::test
