// Contacts have ranks, redundant rows, and alternatives that impose the same constraint.

#include "manycontact/analysis/ranks.hpp"

#include <gtest/gtest.h>

#include <numeric>

#include "manycontact/detail/contact/reference.hpp"
#include "manycontact/dynamics/solve.hpp"
#include "support/dense.hpp"
#include "support/random.hpp"
#include "support/scenes.hpp"

namespace manycontact::test {
namespace {

using Strings = std::vector<std::string>;

struct RankedScene {
  SceneFile file;
  SceneData data;
  explicit RankedScene(SceneFile f) : file(std::move(f)), data(file.scene) {
    (void)solve(file.scene, file.q, file.v, file.u, data);
  }
  IslandRanks ranks(std::size_t island = 0) const { return find_ranks(file.scene, data, island); }
  RowSelection selection() const { return select_rows(file.scene, solved_island(data, 0), ranks()); }
};

RankedScene on_humanoid(const std::string& contacts) {
  return RankedScene(
      load_text("<scene><robot name=\"h\" urdf=\"humanoid.urdf\" base=\"floating\" xyz=\"0 0 0.8\">\n"
                "<joint name=\"left_knee\" q=\"0.8\"/> <joint name=\"right_knee\" q=\"0.6\"/></robot>\n" +
                contacts + "</scene>"));
}

RankedScene on_box(const std::string& contacts) {
  return RankedScene(
      load_text("<scene><robot name=\"b\" urdf=\"box.urdf\" base=\"floating\"/>\n" + contacts + "</scene>"));
}

std::string point(const std::string& name, const std::string& frame, const std::string& more = "") {
  return "<contact name=\"" + name + "\" type=\"3d\" frame=\"" + frame + "\" " + more + "/>\n";
}

// Uses singular values; the contacts' J is computed from the scene, not from the data.
int rank_of(const Eigen::MatrixXd& J) {
  if (J.size() == 0) return 0;
  const Eigen::VectorXd s = Svd(J).sigma;
  return static_cast<int>((s.array() > 1e-9 * s[0]).count());
}

TEST(Ranks, CornersOfTwoSoles) {
  const RankedScene s(load_scene(MANYCONTACT_SOURCE_DIR "/models/feet_on_corners.xml"));
  const IslandRanks ranks = s.ranks();
  EXPECT_TRUE(ranks.known);
  EXPECT_EQ(ranks.rank, 12);
  const RowSelection rows = s.selection();
  EXPECT_EQ(rows.redundant,
            (Strings{"left_2[1]", "left_3[0]", "left_3[1]", "left_4[0]", "left_4[1]", "left_4[2]", "right_2[1]",
                     "right_3[0]", "right_3[1]", "right_4[0]", "right_4[1]", "right_4[2]"}));
  EXPECT_EQ(rows.kept, (Strings{"left_1", "left_2 as 2d (x and z)", "left_3 as 1d along z", "right_1",
                                "right_2 as 2d (x and z)", "right_3 as 1d along z"}));
  EXPECT_EQ(rows.dropped, (Strings{"left_4", "right_4"}));
  ASSERT_EQ(ranks.pairs.size(), 2u);
  EXPECT_EQ(ranks.pairs[1].contacts, (std::vector<int>{4, 5, 6, 7}));
  for (const BodyPair& pair : ranks.pairs) {
    EXPECT_EQ(pair.rows, 12);
    EXPECT_EQ(pair.rank, 6);
    EXPECT_EQ(pair.holds, Holds::kSixD);
    EXPECT_EQ(pair.place_B, "world");
  }
  EXPECT_EQ(ranks.pairs[0].place_A, "humanoid/left_sole");
  EXPECT_TRUE(ranks.lighter.empty());
}

// On random scenes the rank is that of the island's rows, as many rows are redundant as it lacks, and the remaining
// rows have it.
TEST(Ranks, OfRandomScenesAreThoseOfTheirRows) {
  std::mt19937 rng(21);
  int lacking = 0;
  for (int trial = 0; trial < 30; ++trial) {
    SceneOptions options;
    options.redundant = trial % 4;
    const RandomScene r = random_scene(rng, options);
    SceneData data(r.scene);
    (void)solve(r.scene, r.q, r.v, r.u, data);
    const Eigen::MatrixXd J = contact_jacobian(r.scene, r.q);
    for (std::size_t i = 0; i < island_count(data); ++i) {
      const Island& island = solved_island(data, i);
      const IslandRanks ranks = find_ranks(r.scene, data, i);
      std::vector<int> all, kept;
      each_force_block(r.scene, data.f_offset, island, [&](int f, int row, int count) {
        for (int k = 0; k < count; ++k) {
          all.push_back(f + k);
          if (!ranks.redundant[static_cast<std::size_t>(row + k)]) kept.push_back(f + k);
        }
      });
      ASSERT_TRUE(ranks.known);
      EXPECT_EQ(ranks.rank, rank_of(J(all, Eigen::all)));
      EXPECT_EQ(static_cast<int>(kept.size()), ranks.rank);
      EXPECT_EQ(rank_of(J(kept, Eigen::all)), ranks.rank);
      lacking += ranks.rank < island.nc;
    }
  }
  EXPECT_GT(lacking, 10);
}

TEST(Ranks, OneContactThatHoldsWhatTheOthersDo) {
  const RankedScene s =
      on_box(point("c1", "b/top_1") + "<contact name=\"all\" type=\"6d\" frame=\"b/top_2\"/>" + point("c2", "b/top_3"));
  ASSERT_EQ(s.ranks().pairs.size(), 1u);
  EXPECT_EQ(s.ranks().pairs[0].holds, Holds::kOneContact);
  EXPECT_EQ(s.ranks().pairs[0].alone, 1);
}

TEST(Ranks, PointsAtOnePlaceOnALineAndInAPlane) {
  const std::string half =
      "<contact name=\"c2\" type=\"2d\" frame=\"b/top_1\"/><contact name=\"c3\" type=\"1d\" "
      "axis=\"0 1 0\" frame=\"b/top_1\"/><contact name=\"c4\" type=\"1d\" axis=\"1 1 1\" "
      "frame=\"b/top_1\"/>";
  EXPECT_EQ(on_box(half).ranks().pairs[0].holds, Holds::kThreeD);
  const std::string edge = point("c1", "b/top_1") + point("c2", "b/top_2");
  EXPECT_EQ(on_box(edge).ranks().pairs[0].holds, Holds::kLine);
  EXPECT_EQ(on_box(edge).ranks().rank, 5);
  EXPECT_EQ(on_box(edge + point("c3", "b/top_3")).ranks().pairs[0].holds, Holds::kSixD);
  EXPECT_EQ(on_box(point("c1", "b/top_1")).ranks().pairs[0].holds, Holds::kEach);
}

// The body that moves is named first, whichever end of the contact it is.
TEST(Ranks, PairsAreNamedByTheirFrames) {
  const RankedScene s(
      load_text("<scene><robot name=\"h\" urdf=\"humanoid.urdf\" base=\"floating\"/>\n"
                "<robot name=\"b\" urdf=\"box.urdf\" base=\"floating\"/>\n" +
                point("l", "h/left_hand", "to=\"b/face_left\"") + point("r", "b/face_right", "to=\"h/right_hand\"") +
                "</scene>"));
  const IslandRanks ranks = s.ranks();
  ASSERT_EQ(ranks.pairs.size(), 2u);
  EXPECT_EQ(ranks.pairs[0].place_A, "h/left_hand");
  EXPECT_EQ(ranks.pairs[0].place_B, "b/face_left");
  EXPECT_EQ(ranks.pairs[1].place_A, "b/face_right");
  EXPECT_EQ(ranks.pairs[1].place_B, "h/right_hand");
}

// A point on the axis of the only joint moves by rounding error alone: that is no direction.
TEST(Ranks, RoundingIsNoDirection) {
  std::mt19937 rng(22);
  ModelOptions one;
  one.njoints = 1;
  one.types = {JointType::kRevolute};
  one.coordinate_axes = one.plain_placements = 0;
  for (int trial = 0; trial < 20; ++trial) {
    Scene scene;
    add_robot(scene, "r", std::make_shared<Model>(random_model(rng, one)), random_placement(rng));
    const Joint& joint = scene.robots[0].model->joints[0];
    const Eigen::VectorXd q = random_vector(1, rng);
    for (const bool frame : {false, true}) {
      Contact c;
      c.name = frame ? "frame" : "point";
      c.type = frame ? ContactType::k6D : ContactType::k3D;
      c.A = {0, 0, {random_rotation(rng), 0.7 * joint.axis}};
      resolve_reference(scene, q, true, true, c);
      add_contact(scene, c);
    }
    SceneData data(scene);
    for (const bool frame : {false, true}) {
      data.active = {!frame, frame};
      (void)solve(scene, q, Eigen::VectorXd::Zero(1), Eigen::VectorXd::Zero(1), data);
      const IslandRanks ranks = find_ranks(scene, data, 0);
      EXPECT_EQ(ranks.rank, frame ? 1 : 0);
      EXPECT_EQ(ranks.rank, data.report.islands[0].rank);
      EXPECT_EQ(std::accumulate(ranks.redundant.begin(), ranks.redundant.end(), 0), frame ? 5 : 3);
      ASSERT_EQ(ranks.lighter.size(), 1u);
      EXPECT_EQ(ranks.lighter[0].contact, frame ? 1 : 0);
      EXPECT_EQ(ranks.lighter[0].rank, frame ? 1 : 0);
    }
  }
}

// An arm of one lift can be constrained relative to its own fixed base along z only.
TEST(Ranks, LighterTypeOfTheSameRank) {
  std::mt19937 rng(23);
  Model model;
  {
    ModelOptions one;
    one.njoints = 1;
    one.types = {JointType::kPrismatic};
    one.coordinate_axes = one.plain_placements = 1;
    do model = random_model(rng, one);
    while (!model.joints[0].axis.isApprox(Vec3<double>::UnitZ()));
  }
  Scene scene;
  add_robot(scene, "lift", std::make_shared<Model>(model));
  Contact c;
  c.name = "c";
  c.A = {0, 0, {}};
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(1);
  resolve_reference(scene, zero, true, true, c);
  add_contact(scene, c);
  SceneData data(scene);
  (void)solve(scene, zero, zero, zero, data);
  const IslandRanks ranks = find_ranks(scene, data, 0);
  ASSERT_EQ(ranks.lighter.size(), 1u);
  EXPECT_EQ(ranks.lighter[0].rank, 1);
  EXPECT_EQ(ranks.lighter[0].type, "1d along z");
}

TEST(Ranks, LargeIslandsAreLeftOut) {
  const RankedScene s(
      load_edited(MANYCONTACT_SOURCE_DIR "/models/ring_of_humanoids.xml", {{"copies=\"16\"", "copies=\"120\""}}));
  const IslandRanks ranks = s.ranks();
  EXPECT_FALSE(ranks.known);  // nv nc^2 = 4560 2160^2 = 2.1e10
  EXPECT_EQ(ranks.pairs.size(), 360u);
  for (const BodyPair& pair : ranks.pairs) EXPECT_EQ(pair.rank, 6);
}

TEST(Ranks, NeedASolution) {
  const RankedScene s = on_humanoid(point("c", "h/left_sole"));
  const SceneData fresh(s.file.scene);
  EXPECT_THROW((void)find_ranks(s.file.scene, fresh, 0), std::logic_error);
}

}  // namespace
}  // namespace manycontact::test
