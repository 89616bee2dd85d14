#pragma once
#include "manycontact/detail/kkt/island.hpp"

namespace manycontact {

/// The input and output of group_robots. Its memory is reused if the group is not larger than earlier groups.
struct RobotGroups {
  std::vector<char> loose;        // one flag per robot: it is to be grouped; equal for all robots of an island
  std::vector<Island> islands;    // groups of the loose robots, in the order of their first robots
  std::vector<int> sets, number;  // one entry per robot: set of the union-find; number of its root's island
};
/// Groups the robots flagged in groups.loose into islands, or into one island if `whole`. Returns the number of entries
/// of groups.islands in use.
std::size_t group_robots(const Scene& scene, const std::vector<char>& active, bool whole, RobotGroups& groups);

}  // namespace manycontact
