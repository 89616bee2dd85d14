// Rows that are barely independent are listed with their names, their effect, and the solution without them.

#include "manycontact/analysis/near_dependent.hpp"

#include <cmath>
#include <filesystem>

#include "manycontact/analysis/advice.hpp"
#include "manycontact/analysis/ranks.hpp"
#include "manycontact/dynamics/solve.hpp"
#include "support/dense.hpp"
#include "support/folder.hpp"
#include "support/scenes.hpp"
#include "support/terms.hpp"

namespace manycontact::test {
namespace {

struct Solved {
  SceneFile file;
  SceneData data;
  explicit Solved(SceneFile f) : file(std::move(f)), data(file.scene) {
    (void)solve(file.scene, file.q, file.v, file.u, data);
  }
  std::vector<NearDependent> near() const { return near_dependent(file.scene, file.q, data); }
  RankGap gap() const { return rank_gap(file.scene, data, 0); }
};

TEST(NearDependent, ATiltedAxisHoldsALoopStill) {
  for (const double tilt : {1e-4, 3e-6}) {
    const Solved s(tilted_four_bar(tilt));
    const auto found = s.near();
    ASSERT_EQ(found.size(), 1u) << tilt;
    EXPECT_EQ(found[0].island, 0u);
    EXPECT_EQ(found[0].rows, std::vector<int>{2});
    EXPECT_GT(found[0].left, 0.01 * tilt);
    EXPECT_LT(found[0].left, 10 * tilt);
    EXPECT_GT(found[0].times, 0.03 / tilt);
    // without it: the planar loop, from a contact without such a row and dense algebra
    SceneFile plane = tilted_four_bar(tilt);
    const Terms t(plane.scene, {1}, plane.q, plane.v, plane.u);
    const Eigen::MatrixXd J = t.J.topRows(2);
    const Eigen::MatrixXd Minv_Jt = solved(t.M, J.transpose());
    const Eigen::VectorXd a_free = solved(t.M, t.tau_b);
    const Eigen::VectorXd a = a_free + Minv_Jt * solved(J * Minv_Jt, -t.a0.head(2) - J * a_free);
    EXPECT_NEAR(found[0].without, a[found[0].coordinate], 1e-6 * std::abs(a[found[0].coordinate]));
    EXPECT_NEAR(found[0].acceleration, s.data.a[found[0].coordinate], 1e-12 * a.norm());
  }
  EXPECT_TRUE(Solved(tilted_four_bar(0.1)).near().empty());  // an intended spatial loop
  EXPECT_TRUE(Solved(tilted_four_bar(0)).near().empty());    // a planar loop, whose row is dropped
}

// From the tilt on at which the solver keeps the row, it is told, and there is one rank.
TEST(NearDependent, BeginsWhereRowsAreKept) {
  bool dropped = false, kept = false;
  for (const std::string type : {"3d", "5d"})
    for (double tilt = 1e-13; tilt < 1e-5; tilt *= 1.2) {
      const Solved s(tilted_four_bar(tilt, type));
      const IslandReport& report = s.data.report.islands[0];
      SCOPED_TRACE(type + " tilted by " + std::to_string(1e9 * tilt) + "e-9: " + to_string(report.status));
      const bool all = report.rank == (type == "3d" ? 3 : s.data.report.nv);
      (all ? kept : dropped) = true;
      EXPECT_EQ(find_ranks(s.file.scene, s.data, 0).rank, report.rank);
      if (report.status == Status::kOk || report.status == Status::kRedundant)
        EXPECT_EQ(s.near().empty(), s.data.f.cwiseAbs().maxCoeff() < 1e3);
    }
  EXPECT_TRUE(dropped && kept);
}

TEST(NearDependent, RowsWithinTheToleranceAreDependent) {
  SceneFile file = tilted_four_bar(1e-6);
  file.scene.tolerance = 1e-4;
  const Solved s(std::move(file));
  ASSERT_EQ(s.data.report.islands[0].rank, 2);
  EXPECT_TRUE(s.near().empty());
  EXPECT_EQ(s.gap().dropped, 2);
  EXPECT_GT(s.gap().least_kept, 1e-3);
  const IslandRanks ranks = find_ranks(s.file.scene, s.data, 0);
  EXPECT_EQ(ranks.rank, 2);
  EXPECT_EQ(ranks.redundant, (std::vector<char>{0, 0, 1}));
}

TEST(NearDependent, TheGapSaysHowNearItWas) {
  RankGap gap = Solved(tilted_four_bar(0)).gap();
  EXPECT_TRUE(gap.known);
  EXPECT_EQ(gap.dropped, 2);
  EXPECT_GT(gap.gap(), 1e12);
  gap = Solved(tilted_four_bar(1e-6)).gap();
  EXPECT_EQ(gap.kept, 2);
  EXPECT_EQ(gap.dropped, -1);
  EXPECT_LT(gap.least_kept, 1e-5);
  Solved damped(tilted_four_bar(0));
  damped.file.scene.damping = 1e-6;
  (void)solve(damped.file.scene, damped.file.q, damped.file.v, damped.file.u, damped.data);
  EXPECT_FALSE(damped.gap().known);
  EXPECT_TRUE(damped.near().empty());
}

// Two points of a box nearly coincide: a row's residual is as small as their distance, with any arms and units.
TEST(NearDependent, OfPointsThatNearlyCoincide) {
  const auto points = [](const std::string& apart) {
    return Solved(
        load_text("<scene><robot name=\"b\" urdf=\"box.urdf\" base=\"floating\"/>"
                  "<contact name=\"one\" type=\"3d\" frame=\"b/crate\" offset=\"0.3 0 0\"/>"
                  "<contact name=\"two\" type=\"3d\" frame=\"b/crate\" offset=\"0.3 " +
                  apart + " 0\"/></scene>"));
  };
  const Solved s = points("1e-5");
  const auto found = s.near();
  ASSERT_EQ(found.size(), 1u);
  for (const int row : found[0].rows) EXPECT_GE(row, 3);
  EXPECT_EQ(s.data.report.rank, 5);
  EXPECT_TRUE(points("0.2").near().empty());
}

// Rows have residuals of 5e-11 and 5e-12 of an arm: one is accepted, one is not, and both decisions are doubtful.
TEST(NearDependent, AGapThatIsNone) {
  const Solved s(
      load_text("<scene><robot name=\"b\" urdf=\"box.urdf\" base=\"floating\"/>"
                "<contact name=\"one\" type=\"3d\" frame=\"b/crate\" offset=\"0.3 0 0\"/>"
                "<contact name=\"two\" type=\"1d\" axis=\"1 0 0\" frame=\"b/crate\" offset=\"0.3 5e-11 0\"/>"
                "<contact name=\"three\" type=\"1d\" axis=\"1 0 0\" frame=\"b/crate\" offset=\"0.3 0 5e-12\"/>"
                "</scene>"));
  EXPECT_EQ(s.data.report.rank, 4);
  const RankGap gap = s.gap();
  EXPECT_EQ(gap.kept, 3);
  EXPECT_EQ(gap.dropped, 4);
  EXPECT_NEAR(gap.gap(), 10, 0.1);
  EXPECT_LT(gap.gap(), kCloseGap);
}

// The advice does not propose contacts that are redundant as well.
TEST(NearDependent, AdviceDoesNotNameWhatIsAsStuck) {
  const Solved s(tilted_four_bar(3e-6));
  std::string advice;
  for (const std::string& item : advise_on_contacts(s.file.scene, s.data, find_kinds(s.file.scene, s.data)))
    advice += item + "\n";
  EXPECT_NE(advice.find("pin (3d, 3 rows) has rank 2, in addition to 1 nearly dependent row"), std::string::npos)
      << advice;
  EXPECT_NE(advice.find(
                "2d, rotated so that the new y is along the present z, at the same frame imposes the same constraint"),
            std::string::npos)
      << advice;
  EXPECT_EQ(advice.find("3D"), std::string::npos) << advice;
}

TEST(NearDependent, OfFilesRoundedAsCadDoes) {
  const std::string folder = MANYCONTACT_SHARED_DIR "/mechanisms/04-cad-rounding/";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "skipped: no " << folder;
  for (const char* name : {"scene_4_5d.xml", "scene_4_3d.xml", "scene_6_5d.xml", "scene_6_3d.xml"}) {
    const auto found = Solved(load_scene(folder + name)).near();
    ASSERT_EQ(found.size(), 1u) << name;
    EXPECT_NEAR(std::abs(found[0].without), 2.5316, 1e-3) << name;
    EXPECT_GT(found[0].times, 1e3) << name;
  }
  for (const char* name : {"scene_17_5d.xml", "scene_17_3d.xml", "scene_4_2d.xml", "scene_17_2d.xml"})
    EXPECT_TRUE(Solved(load_scene(folder + name)).near().empty()) << name;
}

TEST(NearDependent, NoneInTheModels) {
  for (const std::string& path : model_scenes()) EXPECT_TRUE(Solved(load_small(path)).near().empty()) << path;
}

}  // namespace
}  // namespace manycontact::test
