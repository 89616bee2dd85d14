#include "manycontact/kkt/island.hpp"

#include <algorithm>
#include <numeric>

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

std::vector<Island> find_islands(const Scene& scene, const std::vector<char>& active) {
  std::vector<int> memory(scene.nrobots());
  sparse::UnionFind sets(memory);
  for (std::size_t c = 0; c < scene.contacts.size(); ++c)
    if (active[c] && joins_robots(scene.contacts[c])) sets.join(scene.contacts[c].A.robot, scene.contacts[c].B.robot);
  for (const Spring& spring : scene.springs)
    if (joins_robots(spring)) sets.join(spring.A.robot, spring.B.robot);

  std::vector<Island> islands;
  std::vector<int> number(scene.nrobots(), -1);
  for (int r = 0; r < scene.nrobots(); ++r) {
    const int root = sets.root(r);
    if (number[root] < 0) {
      number[root] = static_cast<int>(islands.size());
      islands.emplace_back();
    }
    islands[number[root]].robots.push_back(r);
  }
  for (std::size_t c = 0; c < scene.contacts.size(); ++c)
    if (active[c]) islands[number[sets.root(robot_of(scene.contacts[c]))]].contacts.push_back(static_cast<int>(c));
  for (Island& island : islands) number_island(scene, island);
  return islands;
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
