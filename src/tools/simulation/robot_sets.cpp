#include "robot_sets.hpp"

#include "manycontact/sparse/union_find.hpp"

namespace manycontact::internal {

void find_robot_sets(const Scene& scene, const std::vector<char>& active, bool by_springs, std::vector<int>& first) {
  first.resize(scene.robots.size());
  sparse::UnionFind sets(first);
  const auto join = [&](const Attachment& A, const Attachment& B) {
    if (moves(A) && moves(B)) sets.join(A.robot, B.robot);
  };
  for (std::size_t c = 0; c < scene.contacts.size(); ++c)
    if (active[c]) join(scene.contacts[c].A, scene.contacts[c].B);
  for (std::size_t s = 0; by_springs && s < scene.springs.size(); ++s) join(scene.springs[s].A, scene.springs[s].B);
  for (std::size_t r = 0; r < first.size(); ++r) first[r] = sets.root(static_cast<int>(r));
}

}  // namespace manycontact::internal
