#include "manycontact/kkt/island.hpp"

#include <algorithm>

#include "manycontact/sparse/union_find.hpp"

namespace manycontact {

std::vector<Island> find_islands(const Scene& scene, const std::vector<char>& active) {
  std::vector<int> memory(scene.nrobots());
  sparse::UnionFind sets(memory);
  for (std::size_t c = 0; c < scene.contacts.size(); ++c)
    if (active[c] && scene.contacts[c].B.robot >= 0) sets.join(scene.contacts[c].A.robot, scene.contacts[c].B.robot);

  std::vector<Island> islands;
  std::vector<int> number(scene.nrobots(), -1);
  for (int r = 0; r < scene.nrobots(); ++r) {
    const int root = sets.root(r);
    if (number[root] < 0) {
      number[root] = static_cast<int>(islands.size());
      islands.emplace_back();
    }
    Island& island = islands[number[root]];
    island.robots.push_back(r);
    island.dof_offset.push_back(island.nv);
    island.nv += scene.robots[r].model->nv;
  }
  for (std::size_t c = 0; c < scene.contacts.size(); ++c) {
    if (!active[c]) continue;
    Island& island = islands[number[sets.root(scene.contacts[c].A.robot)]];
    island.contacts.push_back(static_cast<int>(c));
    island.row_offset.push_back(island.nc);
    island.nc += scene.contacts[c].rows();
  }
  return islands;
}

int local_robot(const Island& island, int robot) {
  return static_cast<int>(std::lower_bound(island.robots.begin(), island.robots.end(), robot) - island.robots.begin());
}

}  // namespace manycontact
