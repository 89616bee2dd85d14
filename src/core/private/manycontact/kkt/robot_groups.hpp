#pragma once
#include "manycontact/detail/kkt/island.hpp"

namespace manycontact {

/// Memory of group_robots, reused for groups up to the largest size so far.
struct RobotGroups {
  std::vector<char> loose;        // one flag per robot: to be grouped; must be set for all robots of an island
  std::vector<Island> islands;    // islands of the loose robots, in the order of their first robots
  std::vector<int> sets, number;  // one entry per robot: union-find; number of the island of its root
};
/// Groups the loose robots into islands, or one if `whole`; returns the number of entries of groups.islands used.
std::size_t group_robots(const Scene& scene, const std::vector<char>& active, bool whole, RobotGroups& groups);

}  // namespace manycontact
