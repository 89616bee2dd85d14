// Islands have kinds, and advice concerns contacts and bodies.

#include "manycontact/analysis/advice.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "manycontact/dynamics/solve.hpp"
#include "spatial/compare.hpp"
#include "support/scenes.hpp"

namespace manycontact::test {
namespace {

using Strings = std::vector<std::string>;

struct Advised {
  SceneFile file;
  SceneData data;
  std::vector<IslandKind> kinds;
  Strings contacts, bodies;
  explicit Advised(SceneFile f) : file(std::move(f)), data(file.scene) {
    (void)solve(file.scene, file.q, file.v, file.u, data);
    kinds = find_kinds(file.scene, data);
    contacts = advise_on_contacts(file.scene, data, kinds);
    bodies = advise_on_bodies(file.scene, data);
  }
};

std::string model(const std::string& name) { return std::string(MANYCONTACT_SOURCE_DIR "/models/") + name; }

bool says(const Strings& advice, const std::string& part) {
  return std::any_of(advice.begin(), advice.end(), [&](const std::string& s) { return s.find(part) != s.npos; });
}

std::string all(const Strings& advice) {
  std::string text;
  for (const std::string& item : advice) text += item + "\n";
  return text;
}

TEST(Kinds, OfAHerdAreOne) {
  const Advised s{load_scene(model("herd.xml"))};
  ASSERT_EQ(s.kinds.size(), 1u);
  EXPECT_EQ(s.kinds[0].islands.size(), 64u);
  EXPECT_EQ(s.kinds[0].ranks.rank, 12);
  EXPECT_EQ(all(s.contacts), "");
}

// The islands have the same shape, but one arm is stretched out: its tool cannot move away from the shoulder.
TEST(Kinds, DifferInTheirRanks) {
  const auto arm = [](const std::string& name, const std::string& elbow) {
    return "<robot name=\"" + name +
           "\" urdf=\"arm.urdf\" base=\"fixed\"><joint name=\"shoulder_pitch\" q=\"0.4\"/><joint name=\"elbow\" q=\"" +
           elbow + "\"/><joint name=\"wrist_pitch\" q=\"0.7\"/></robot><contact name=\"on_" + name +
           "\" type=\"6d\" frame=\"" + name + "/tool\"/>\n";
  };
  const Advised s{load_text("<scene>" + arm("a", "0.9") + arm("b", "0") + arm("c", "0.9") + "</scene>")};
  ASSERT_EQ(s.kinds.size(), 2u);
  EXPECT_EQ(s.kinds[0].islands, (std::vector<int>{0, 2}));
  EXPECT_EQ(s.kinds[1].islands, (std::vector<int>{1}));
  EXPECT_EQ(s.kinds[0].ranks.rank, 6);
  EXPECT_EQ(s.kinds[1].ranks.rank, 5);
  EXPECT_TRUE(says(s.contacts, "on_b (6d, 6 rows) has rank 5")) << all(s.contacts);
  EXPECT_FALSE(says(s.contacts, "on_a")) << all(s.contacts);
}

TEST(Advice, OnCorners) {
  const Advised s{load_scene(model("feet_on_corners.xml"))};
  for (const char* part :
       {"the 24 contact rows of humanoid have rank 12; 12 rows are redundant, since the preceding rows impose the same "
        "constraint: "
        "left_2[1], left_3[0]",
        "to be dropped: left_4, right_4",
        "left_1 .. left_4, 12 rows of rank 6: one 6D contact on `humanoid/left_sole` imposes the same constraint",
        "after this change, 12 rows replace 24, and all are linearly independent"})
    EXPECT_TRUE(says(s.contacts, part)) << part << "\n" << all(s.contacts);
  EXPECT_TRUE(says(s.bodies, "humanoid: 20 joints could be locked")) << all(s.bodies);
}

TEST(Advice, OnAlikeIslandsIsGivenOnce) {
  const Advised s{load_text(R"(<scene><robot name="b" urdf="box.urdf" base="floating" copies="5" spacing="2"/>
    <contact name="c" type="3d" frame="b/top_1"/> <contact name="d" type="3d" frame="b/top_1"/></scene>)")};
  ASSERT_EQ(s.kinds.size(), 1u);
  EXPECT_TRUE(says(s.contacts, "the 6 contact rows of b0 have rank 3")) << all(s.contacts);
  EXPECT_TRUE(says(s.contacts, "(4 more identical islands)")) << all(s.contacts);
  EXPECT_FALSE(says(s.contacts, "b1")) << all(s.contacts);
}

// Following the advice, row by row, changes no acceleration of a collapsing humanoid with one sole on its corners.
TEST(Advice, OnRowsHolds) {
  const std::string head =
      "<scene><robot name=\"h\" urdf=\"humanoid.urdf\" base=\"floating\" xyz=\"0 0 0.8\">\n"
      "<joint name=\"left_knee\" q=\"0.8\"/> <joint name=\"left_hip_pitch\" q=\"-0.3\"/></robot>\n";
  const char* offsets[] = {"0.12 0.045 0", "0.12 -0.045 0", "-0.12 -0.045 0", "-0.12 0.045 0.01"};
  const char* axes[] = {"1 0 0", "0 1 0", "0 0 1"};
  const auto contact = [&](std::size_t k, const std::string& type) {
    return "<contact name=\"c" + std::to_string(k) + "\" frame=\"h/left_sole\" offset=\"" + offsets[k / 3] +
           "\" type=" + type + "/>\n";
  };
  std::string points, rows;
  for (std::size_t k = 0; k < 12; k += 3) points += contact(k, "\"3d\"");
  const Advised s{load_text(head + points + "</scene>")};
  const std::vector<char>& redundant = s.kinds[0].ranks.redundant;
  ASSERT_EQ(redundant.size(), 12u);
  EXPECT_EQ(s.kinds[0].ranks.rank, 6);
  EXPECT_TRUE(says(s.contacts, "to be dropped: ")) << all(s.contacts);
  for (std::size_t k = 0; k < redundant.size(); ++k)
    if (!redundant[k]) rows += contact(k, std::string("\"1d\" axis=\"") + axes[k % 3] + "\"");

  Advised lighter{load_text(head + rows + "</scene>")};
  EXPECT_EQ(lighter.data.report.nc, 6);
  EXPECT_EQ(all(lighter.contacts), "");
  estimate_condition(lighter.file.scene, lighter.data);
  const double size = s.data.a.cwiseAbs().maxCoeff(), condition = lighter.data.report.condition;
  EXPECT_GT(size, 1);
  EXPECT_LE((s.data.a - lighter.data.a).cwiseAbs().maxCoeff(), std::max(1e-12, 200 * kEps * condition) * size);
}

TEST(Advice, OnBodiesThatNothingMoves) {
  const Advised s{load_text(R"(<scene gravity="0 0 0"><robot name="idle" urdf="arm.urdf" base="fixed"/>
    <robot name="busy" urdf="arm.urdf" base="fixed"><joint name="shoulder_yaw" v="1"/></robot>
    <robot name="box" urdf="box.urdf" base="floating" copies="5"/></scene>)")};
  EXPECT_TRUE(says(s.bodies, "idle: the robot is fixed to the world, at rest and without contact")) << all(s.bodies);
  EXPECT_TRUE(says(s.bodies, "box0 .. box4: the robot floats freely, without contact")) << all(s.bodies);
  EXPECT_FALSE(says(s.bodies, "busy: the robot is fixed")) << all(s.bodies);
}

TEST(Advice, NeedsASolution) {
  const SceneFile file = load_scene(model("humanoid_standing.xml"));
  const SceneData fresh(file.scene);
  EXPECT_THROW((void)find_kinds(file.scene, fresh), std::logic_error);
  EXPECT_THROW((void)advise_on_contacts(file.scene, fresh, {}), std::logic_error);
  EXPECT_THROW((void)advise_on_bodies(file.scene, fresh), std::logic_error);
}

// The advice is plain text for any use: a terminal breaks the lines itself.
TEST(Advice, IsPlainText) {
  for (const std::string& path : model_scenes()) {
    const Advised s{load_scene(path)};
    for (const Strings& advice : {s.contacts, s.bodies})
      for (const std::string& item : advice)
        EXPECT_TRUE(std::all_of(item.begin(), item.end(), [](unsigned char c) { return c >= ' ' && c < 0x7f; }))
            << item;
  }
}

}  // namespace
}  // namespace manycontact::test
