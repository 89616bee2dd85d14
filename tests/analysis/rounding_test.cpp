// Numbers of a solution that are rounding error alone are found.

#include "manycontact/analysis/rounding.hpp"

#include <gtest/gtest.h>

#include "manycontact/dynamics/solve.hpp"
#include "support/scenes.hpp"

namespace manycontact::test {
namespace {

using Strings = std::vector<std::string>;

Strings rounding_of(const SceneFile& file, const Options& options = {}) {
  SceneData data(file.scene, options);
  (void)solve(file.scene, file.q, file.v, file.u, data);
  EXPECT_EQ(find_rounding(data.report).names(), Strings()) << "before estimate_errors";
  estimate_errors(file.scene, data);
  return find_rounding(data.report).names();
}

TEST(Rounding, AccelerationsOfASceneAtRest) {
  const SceneFile still = load_scene(MANYCONTACT_SOURCE_DIR "/models/humanoid_standing.xml");
  for (Method method : kMethods)
    EXPECT_EQ(rounding_of(still, {method, {}}), Strings{"acceleration"}) << to_string(method);
  SceneFile moving = still;
  moving.u[3] += 1;
  EXPECT_EQ(rounding_of(moving), Strings());
}

TEST(Rounding, ForcesWhereNothingPushes) {
  const std::string box = R"(<robot name="b" urdf="box.urdf" base="floating"><v>0 0 0 0.3 0.1 0.2</v></robot>
    <contact name="c" type="3d" frame="b/top_1"/></scene>)";
  EXPECT_EQ(rounding_of(load_text("<scene>" + box)), Strings());
  const SceneFile falling = load_text(R"(<scene><robot name="b" urdf="box.urdf" base="floating" rpy="0.3 0.4 0.5"/>
    <robot name="c" urdf="box.urdf" base="floating" xyz="2 0 0" rpy="0.3 0.4 0.5"/>
    <contact name="tie" type="6d" frame="b/face_top" to="c/face_top"/></scene>)");  // both fall alike: no forces
  EXPECT_EQ(rounding_of(falling), Strings{"forces"});
}

TEST(Rounding, OfOneIslandIsSaidOfTheReport) {
  Report report;
  report.islands.resize(2);
  report.islands[0].error_acceleration = 1e-12;
  report.islands[1].error_acceleration = 1519;
  EXPECT_EQ(find_rounding(report.islands[0]).names(), Strings());
  EXPECT_EQ(find_rounding(report.islands[1]).names(), Strings{"acceleration"});
  EXPECT_EQ(find_rounding(report).names(), Strings{"acceleration"});
  report.islands[0].error_forces = std::numeric_limits<double>::infinity();  // zero forces
  EXPECT_EQ(find_rounding(report).names(), (Strings{"acceleration", "forces"}));
}

TEST(Rounding, AFailureIsNone) {
  IslandReport failed;
  failed.status = Status::kFailed;
  failed.error_acceleration = failed.error_forces = std::numeric_limits<double>::infinity();
  EXPECT_EQ(find_rounding(failed).names(), Strings());
}

}  // namespace
}  // namespace manycontact::test
