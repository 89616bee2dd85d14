#pragma once
#include "manycontact/detail/kkt/island.hpp"

namespace manycontact {

/// Memory of group_robots, which allocates nothing for groups as large as any before.
struct RobotGroups {
  std::vector<char> loose;        // one flag per robot: it is to be grouped, together with all that were in its island
  std::vector<Island> islands;    // islands of the loose robots, in the order of their first ones
  std::vector<int> sets, number;  // one entry per robot: union-find; number of its root's island
};
/// The loose robots' islands of the scene with its springs and the given contacts active; `whole`: all of them one.
/// Returns how many of groups.islands they are.
std::size_t group_robots(const Scene& scene, const std::vector<char>& active, bool whole, RobotGroups& groups);

}  // namespace manycontact
