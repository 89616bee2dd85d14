// Contacts are switched on and off: only their islands change, no set is analysed twice, sets solved before allocate
// nothing, and solutions do not depend on earlier sets.

#include <gtest/gtest.h>

#include "manycontact/algorithm/integrate.hpp"
#include "manycontact/dynamics/differentiate.hpp"
#include "manycontact/dynamics/shapes.hpp"
#include "manycontact/dynamics/solve.hpp"
#include "manycontact/dynamics/views.hpp"
#include "support/allocations.hpp"
#include "support/methods.hpp"
#include "support/random.hpp"
#include "support/scenes.hpp"
#include "support/workspace.hpp"

namespace manycontact::test {
namespace {

void solve_at(const SceneFile& file, SceneData& data) { (void)solve(file.scene, file.q, file.v, file.u, data); }

int contact_named(const Scene& scene, const std::string& name) { return scene.contact_index.at(name); }

// In a herd of quadrupeds one lifts a foot, then another one lifts the same foot.
TEST(Switching, TouchesItsIslandAlone) {
  SceneFile file = load_scene(kModels + "herd.xml");
  SceneData data(file.scene, {Method::kSparseLdl, {}, SimdLevel::kOff});
  solve_at(file, data);
  ASSERT_EQ(shapes_analysed(data), 1u);
  std::vector<const double*> before;
  for (std::size_t i = 0; i < island_count(data); ++i)
    before.push_back(assembled_matrix_of(file.scene, data, i).values.data());
  const int lifted = contact_named(file.scene, file.scene.contacts[0].name);
  const int of = island_with_robot(data, file.scene.contacts[lifted].A.robot);
  data.active[lifted] = 0;
  solve_at(file, data);
  EXPECT_EQ(shapes_analysed(data), 2u);
  for (std::size_t i = 0; i < island_count(data); ++i)
    EXPECT_EQ(assembled_matrix_of(file.scene, data, i).values.data() == before[i], static_cast<int>(i) != of) << i;
  // The same foot of another robot gives a shape seen before, in the memory of the first.
  data.active[lifted] = 1;
  solve_at(file, data);
  const std::size_t next = file.scene.contacts.size() / 64;  // per robot
  data.active[lifted + next] = 0;
  solve_at(file, data);
  EXPECT_EQ(shapes_analysed(data), 2u);
}

// The memory of earlier sets is bounded: a set that was dropped is analysed again, to the same bits.
TEST(Switching, GivesUpSetsMetLongAgo) {
  const SceneFile file = load_small(kModels + "ring_of_humanoids.xml");
  SceneData kept(file.scene), bounded(file.scene);
  prepare(file.scene, bounded);
  limit_pool(bounded, 1);
  std::mt19937 rng(5);
  for (int round = 0; round < 30; ++round) {
    for (std::size_t c = 0; c < file.scene.contacts.size(); ++c) kept.active[c] = bounded.active[c] = rng() % 4 != 0;
    for (SceneData* data : {&kept, &bounded}) {
      solve_at(file, *data);
      differentiate(file.scene, *data);
    }
    EXPECT_EQ(bounded.a, kept.a) << round;
    EXPECT_EQ(bounded.f, kept.f) << round;
    for (std::size_t i = 0; i < island_count(kept); ++i)
      EXPECT_EQ(derivatives(bounded).islands[i].X, derivatives(kept).islands[i].X) << round;
    EXPECT_LE(shapes_analysed(bounded), island_count(bounded) + 8) << round;
  }
  EXPECT_GT(shapes_analysed(kept), 20u);
}

// Robots release each other and join hands again: islands split, merge, and keep their order.
TEST(Switching, SplitsAndJoinsIslands) {
  SceneFile file = load_small(kModels + "ring_of_humanoids.xml");
  const Scene& scene = file.scene;
  SceneData data(scene);
  ASSERT_EQ(island_count(data), 1u);
  std::vector<int> holds;
  for (std::size_t c = 0; c < scene.contacts.size(); ++c)
    if (scene.contacts[c].B.robot >= 0) holds.push_back(static_cast<int>(c));
  ASSERT_EQ(holds.size(), 4u);
  std::mt19937 rng(3);
  for (int round = 0; round < 40; ++round) {
    for (int c : holds) data.active[c] = rng() % 2;
    prepare(scene, data);
    const std::vector<Island> expected = find_islands(scene, data.active);
    ASSERT_EQ(island_count(data), expected.size());
    for (std::size_t i = 0; i < expected.size(); ++i) {
      EXPECT_EQ(solved_island(data, i).robots, expected[i].robots);
      EXPECT_EQ(solved_island(data, i).contacts, expected[i].contacts);
      EXPECT_EQ(solved_island(data, i).dof_offset, expected[i].dof_offset);
      EXPECT_EQ(solved_island(data, i).row_offset, expected[i].row_offset);
      for (int r : expected[i].robots) EXPECT_EQ(island_with_robot(data, r), static_cast<int>(i));
    }
  }
}

// After any sequence of contact sets, values, derivatives and reports have the bits that new data give.
TEST(Switching, ForgetsWhatWasBefore) {
  for (const char* name : {"ring_of_humanoids", "herd", "feet_on_corners", "two_humanoids_carry_beam"}) {
    SceneFile file = load_small(kModels + name + ".xml");
    const Scene& scene = file.scene;
    std::mt19937 rng(17);
    disturb(file, rng);
    for (const Way& way : ways(true)) {
      SCOPED_TRACE(std::string(name) + ", " + way.name);
      SceneData walked(scene, way.options);
      for (int step = 0; step < 5; ++step) {
        for (char& active : walked.active) active = rng() % 3 > 0;
        solve_at(file, walked);
        SceneData fresh(scene, way.options);
        fresh.active = walked.active;
        solve_at(file, fresh);
        EXPECT_EQ(walked.report.status, fresh.report.status);
        ASSERT_EQ(walked.report.islands.size(), fresh.report.islands.size());
        for (std::size_t i = 0; i < fresh.report.islands.size(); ++i) {
          EXPECT_EQ(walked.report.islands[i].method, fresh.report.islands[i].method);
          EXPECT_EQ(walked.report.islands[i].order, fresh.report.islands[i].order);
          EXPECT_EQ(walked.report.islands[i].reason, fresh.report.islands[i].reason);
          EXPECT_EQ(walked.report.islands[i].dependent_rows, fresh.report.islands[i].dependent_rows);
        }
        if (fresh.report.status == Status::kFailed) continue;
        EXPECT_TRUE(walked.a == fresh.a);
        EXPECT_TRUE(walked.f == fresh.f);
        if (step % 2) continue;  // not every solve is differentiated
        differentiate(scene, walked);
        differentiate(scene, fresh);
        const SceneDerivatives d = dense_derivatives(scene, walked), e = dense_derivatives(scene, fresh);
        EXPECT_TRUE(d.da_dq == e.da_dq && d.dforces_dq == e.dforces_dq && d.dforces_dv == e.dforces_dv);
      }
    }
  }
}

// Sets solved before allocate nothing with these sparse methods; a new set costs the analysis of one island.
TEST(Switching, AllocatesNothingForSetsMetBefore) {
  if (!MANYCONTACT_COUNTS_ALLOCATIONS) GTEST_SKIP() << "malloc cannot be counted here";
  SceneFile file = load_scene(kModels + "herd.xml");
  std::mt19937 rng(2);
  disturb(file, rng);
  for (const Way& way : ways_here()) {
    if (way.options.method == Method::kDenseSchur) continue;
    SCOPED_TRACE(way.name);
    SceneData data(file.scene, way.options);
    const auto with = [&](int contact, bool active) {
      data.active[contact] = active;
      solve_at(file, data);
      differentiate(file.scene, data);
    };
    with(0, true);
    with(0, false);  // a new set
    with(0, true);
    for (int again = 0; again < 3; ++again) {
      EXPECT_EQ(allocations([&] { with(0, false); }), 0u);
      EXPECT_EQ(allocations([&] { with(0, true); }), 0u);
      EXPECT_EQ(allocations([&] { with(9, false); }), 0u);  // the same foot of another robot
      EXPECT_EQ(allocations([&] { with(9, true); }), 0u);
    }
  }
}

// Contacts at different points of the same bodies have the orders that each would have alone.
TEST(Shapes, OrdersDoNotDependOnWhatWasSeenBefore) {
  std::mt19937 rng(9);
  const auto model = std::make_shared<Model>(
      random_model(rng, {.njoints = 9, .floating_base = true, .types = {JointType::kRevolute}, .branching = 0}));
  const auto scene_with = [&](const std::vector<Vec3<double>>& points) {
    Scene scene;
    for (std::size_t r = 0; r < points.size(); ++r) {
      add_robot(scene, "r" + std::to_string(r), model);
      Contact c;
      c.name = "c" + std::to_string(r);
      c.type = ContactType::k3D;
      c.A = {static_cast<int>(r), 8, {}};
      c.A.placement.p = points[r];
      add_contact(scene, c);
    }
    return scene;
  };
  // the first is on the last joint's axis, which does not move it; the second is off it
  const Vec3<double> on = 0.3 * model->joints[8].axis, off = on + 4 * model->joints[8].axis.unitOrthogonal();
  const auto orders = [&](const std::vector<Vec3<double>>& points) {
    const Scene scene = scene_with(points);
    const SceneData data(scene, {Method::kSparseLdl, Order::kContactsEarly});
    std::vector<std::vector<int>> perms;
    for (std::size_t i = 0; i < island_count(data); ++i)
      perms.push_back(shape_of(data, i)->pattern(Order::kContactsEarly)->perm);
    return perms;
  };
  const auto alone_on = orders({on})[0], alone_off = orders({off})[0];
  EXPECT_NE(alone_on, alone_off);
  EXPECT_EQ(orders({on, off}), (std::vector{alone_on, alone_off}));
  EXPECT_EQ(orders({off, on}), (std::vector{alone_off, alone_on}));
  const Scene many = scene_with({off, off * 1.01, off * 1.02, off * 1.03});
  EXPECT_EQ(shapes_analysed(SceneData(many)), 1u);  // other places, the same order: one analysis
}

}  // namespace
}  // namespace manycontact::test
