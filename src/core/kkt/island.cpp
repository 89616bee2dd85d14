#include "manycontact/detail/kkt/island.hpp"

#include <algorithm>
#include <numeric>

#include "manycontact/kkt/robot_groups.hpp"
#include "manycontact/sparse/union_find.hpp"

namespace manycontact {

void number_island(const Scene& scene, Island& island) {
  island.dof_offset.clear();
  island.row_offset.clear();
  island.nv = island.nc = 0;
  for (int r : island.robots) {
    island.dof_offset.push_back(island.nv);
    island.nv += scene.robots[r].model->nv;
  }
  for (int c : island.contacts) {
    island.row_offset.push_back(island.nc);
    island.nc += scene.contacts[c].rows();
  }
}

std::size_t group_robots(const Scene& scene, const std::vector<char>& active, bool whole, RobotGroups& s) {
  s.sets.resize(scene.robots.size());
  s.number.assign(scene.robots.size(), -1);
  sparse::UnionFind sets(s.sets);
  for (int r = 1; whole && r < scene.nrobots(); ++r) sets.join(0, r);
  for (std::size_t c = 0; c < scene.contacts.size(); ++c) {
    const Contact& contact = scene.contacts[c];
    if (active[c] && joins_robots(contact) && s.loose[contact.A.robot]) sets.join(contact.A.robot, contact.B.robot);
  }
  for (const Spring& spring : scene.springs)
    if (joins_robots(spring) && s.loose[spring.A.robot]) sets.join(spring.A.robot, spring.B.robot);
  std::size_t count = 0;
  for (int r = 0; r < scene.nrobots(); ++r) {
    if (!s.loose[r]) continue;
    int& number = s.number[sets.root(r)];
    if (number < 0) {
      number = static_cast<int>(count++);
      if (s.islands.size() < count) s.islands.emplace_back();
      s.islands[number].robots.clear();
      s.islands[number].contacts.clear();
    }
    s.islands[number].robots.push_back(r);
  }
  for (std::size_t c = 0; c < scene.contacts.size(); ++c) {
    const int robot = robot_of(scene.contacts[c]);
    if (active[c] && s.loose[robot]) s.islands[s.number[sets.root(robot)]].contacts.push_back(static_cast<int>(c));
  }
  for (std::size_t k = 0; k < count; ++k) number_island(scene, s.islands[k]);
  return count;
}

std::vector<Island> find_islands(const Scene& scene, const std::vector<char>& active) {
  RobotGroups all;
  all.loose.assign(scene.robots.size(), 1);
  group_robots(scene, active, false, all);
  return std::move(all.islands);
}

Island whole_scene(const Scene& scene, const std::vector<char>& active) {
  Island island;
  island.robots.resize(scene.robots.size());
  std::iota(island.robots.begin(), island.robots.end(), 0);
  for (std::size_t c = 0; c < scene.contacts.size(); ++c)
    if (active[c]) island.contacts.push_back(static_cast<int>(c));
  number_island(scene, island);
  return island;
}

int local_robot(const Island& island, int robot) {
  return static_cast<int>(std::lower_bound(island.robots.begin(), island.robots.end(), robot) - island.robots.begin());
}

int first_dof(const Island& island, const Attachment& end) {
  return moves(end) ? island.dof_offset[local_robot(island, end.robot)] : 0;
}

}  // namespace manycontact
