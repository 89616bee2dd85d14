#pragma once
#include "manycontact/detail/kkt/island.hpp"

namespace manycontact {

/// Memory of group_robots; it is reused if the group is not larger than earlier groups.
struct RobotGroups {
  std::vector<char> loose;        // one flag per robot: it is to be grouped; the caller sets all flags of an island
  std::vector<Island> islands;    // groups of the loose robots, in the order of their first robots
  std::vector<int> sets, number;  // one entry per robot: set of the union-find; number of its root's island
};
/// Groups loose robots into islands, or into one if `whole`; returns the number of entries of groups.islands in use.
std::size_t group_robots(const Scene& scene, const std::vector<char>& active, bool whole, RobotGroups& groups);

}  // namespace manycontact
