#pragma once
#include <vector>

#include "manycontact/model/scene.hpp"

namespace manycontact::internal {

/// Finds for each robot the first robot of its set. Contacts flagged `active` join robots, and springs if `by_springs`.
void find_robot_sets(const Scene& scene, const std::vector<char>& active, bool by_springs, std::vector<int>& first);

}  // namespace manycontact::internal
