// Islands determine which robots belong together, and where their coordinates and rows are.

#include "manycontact/detail/kkt/island.hpp"

#include <gtest/gtest.h>

#include "manycontact/kkt/shape.hpp"
#include "support/random.hpp"

namespace manycontact::test {
namespace {

using Numbers = std::vector<int>;

// Returns six free bodies (the last is separate) with contacts between the given pairs; -1: the world.
Scene bodies(const std::vector<std::pair<int, int>>& pairs) {
  std::mt19937 rng(1);
  const auto model = std::make_shared<Model>(random_model(rng, {.njoints = 2, .floating_base = true}));
  Scene scene;
  for (int r = 0; r < 6; ++r) add_robot(scene, "r" + std::to_string(r), model);
  for (const auto& [a, b] : pairs) {
    Contact c;
    c.name = "c" + std::to_string(scene.contacts.size());
    c.type = ContactType::k3D;
    c.A = {a, 1, {}};
    if (b >= 0) c.B = {b, 0, {}};
    add_contact(scene, c);
  }
  return scene;
}

TEST(Islands, WithoutContactsEveryRobotIsOne) {
  const std::vector<Island> islands = find_islands(bodies({}), {});
  ASSERT_EQ(islands.size(), 6u);
  for (int r = 0; r < 6; ++r) {
    EXPECT_EQ(islands[r].robots, Numbers{r});
    EXPECT_EQ(islands[r].nc, 0);
    EXPECT_EQ(islands[r].size(), islands[r].nv);
  }
}

TEST(Islands, TheWorldAndLoopsJoinNothing) {
  EXPECT_EQ(find_islands(bodies({{0, -1}, {1, -1}, {2, 2}}), {1, 1, 1}).size(), 6u);
}

// A is on the base of a fixed robot: the contact belongs to B's island, which contains nothing of A's robot.
TEST(Islands, ABaseThatStandsJoinsNothing) {
  Scene scene = bodies({{0, 1}, {3, -1}});
  std::mt19937 rng(2);
  const int arm = add_robot(scene, "arm", std::make_shared<Model>(random_model(rng, {.njoints = 3})));
  for (int r : {1, 4}) {
    Contact c;
    c.name = "on " + std::to_string(r);
    c.A = {arm, -1, {}};
    c.B = {r, 0, {}};
    add_contact(scene, c);
  }
  const std::vector<Island> islands = find_islands(scene, {1, 1, 1, 1});
  ASSERT_EQ(islands.size(), 6u);
  EXPECT_EQ(islands[0].robots, (Numbers{0, 1}));
  EXPECT_EQ(islands[0].contacts, (Numbers{0, 2}));
  EXPECT_EQ(islands[3].contacts, (Numbers{3}));
  EXPECT_EQ(islands[5].robots, Numbers{arm});
  EXPECT_EQ(islands[5].nc, 0);
  for (const int c : {2, 3}) {
    EXPECT_EQ(robot_of(scene.contacts[c]), scene.contacts[c].B.robot);
    EXPECT_EQ(first_dof(islands[0], scene.contacts[c].A), 0);
  }
  EXPECT_EQ(first_dof(islands[0], scene.contacts[2].B), scene.robots[0].model->nv);
}

TEST(Islands, ContactsBetweenBodiesJoin) {
  const Scene scene = bodies({{4, 1}, {0, -1}, {1, 3}, {5, 2}, {3, 4}});
  const std::vector<Island> islands = find_islands(scene, {1, 1, 1, 1, 1});
  ASSERT_EQ(islands.size(), 3u);  // in the order of their first robots
  const int nv = scene.robots[0].model->nv;
  EXPECT_EQ(islands[0].robots, Numbers{0});
  EXPECT_EQ(islands[0].contacts, Numbers{1});
  EXPECT_EQ(islands[1].robots, (Numbers{1, 3, 4}));
  EXPECT_EQ(islands[1].contacts, (Numbers{0, 2, 4}));
  EXPECT_EQ(islands[1].dof_offset, (Numbers{0, nv, 2 * nv}));
  EXPECT_EQ(islands[1].row_offset, (Numbers{0, 3, 6}));
  EXPECT_EQ(islands[1].nv, 3 * nv);
  EXPECT_EQ(islands[1].nc, 9);
  EXPECT_EQ(islands[1].size(), 3 * nv + 9);
  EXPECT_EQ(islands[2].robots, (Numbers{2, 5}));
  EXPECT_EQ(islands[2].contacts, Numbers{3});
  for (int k = 0; k < 3; ++k) EXPECT_EQ(local_robot(islands[1], islands[1].robots[k]), k);
}

TEST(Islands, InactiveContactsNeitherJoinNorCount) {
  const std::vector<Island> islands = find_islands(bodies({{0, 1}, {1, 2}, {2, -1}}), {1, 0, 0});
  ASSERT_EQ(islands.size(), 5u);
  EXPECT_EQ(islands[0].robots, (Numbers{0, 1}));
  EXPECT_EQ(islands[0].nc, 3);
  EXPECT_EQ(islands[1].nc, 0);
}

TEST(Islands, AlikeIslandsShareAShape) {
  const Scene scene = bodies({{0, 1}, {2, 3}, {5, 4}, {0, -1}, {2, -1}});
  ShapeCache cache;
  const auto shape = [&](const std::vector<char>& active, int k) {
    return cache.find(scene, find_islands(scene, active)[k]).get();
  };
  EXPECT_EQ(shape({1, 1, 1, 1, 1}, 0), shape({1, 1, 1, 1, 1}, 1));
  // robot 5 is A there, and it has no contact with the world
  EXPECT_NE(shape({1, 1, 1, 1, 1}, 0), shape({1, 1, 1, 1, 1}, 2));
  EXPECT_NE(shape({1, 1, 1, 1, 0}, 0), shape({1, 1, 1, 1, 0}, 1));
}

// Data of one scene share the same analyses, as long as any of them exists.
TEST(Islands, CachesShareTheShapesAtHand) {
  const Scene scene = bodies({{0, 1}, {2, 3}});
  const Island island = find_islands(scene, {1, 1})[0];
  std::weak_ptr<IslandShape> shape;
  {
    ShapeCache second;
    {
      ShapeCache first;
      shape = first.find(scene, island);
      EXPECT_EQ(second.find(scene, island), shape.lock());
    }
    EXPECT_FALSE(shape.expired());
  }
  EXPECT_TRUE(shape.expired());
  const Scene other = bodies({{0, 1}, {2, 3}});  // models of its own
  ShapeCache first, second;
  EXPECT_NE(first.find(scene, island), second.find(other, island));
}

}  // namespace
}  // namespace manycontact::test
