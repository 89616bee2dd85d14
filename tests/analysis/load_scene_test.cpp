// Scenes are loaded from files with the torques of u="gravity".

#include "manycontact/analysis/load_scene.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "manycontact/dynamics/quasi_static.hpp"
#include "support/scenes.hpp"

namespace manycontact::test {
namespace {

// A copied arm has gravity torques, between one with given torques and one without any.
TEST(LoadScene, GravityTorquesOfTheRobotsThatAskForThem) {
  const std::string arm = R"( urdf="arm.urdf" base="fixed")", bent = R"(<joint name="shoulder_pitch" q="0.7"/>)";
  const SceneFile s = load_text("<scene><robot name=\"a\"" + arm + ">" + bent + "<u>1 2 3 4 5 6 7</u></robot>\n" +
                                "<robot name=\"b\"" + arm + " copies=\"2\" spacing=\"3\" u=\"gravity\">" + bent +
                                "</robot>\n<robot name=\"c\"" + arm + ">" + bent + "</robot></scene>");
  EXPECT_EQ(s.gravity_robots, (std::vector<int>{1, 2}));
  const Eigen::VectorXd still = quasi_static(s.scene, s.q);
  EXPECT_GT(still.segment(7, 14).cwiseAbs().maxCoeff(), 1);
  EXPECT_EQ(s.u.segment(7, 14), still.segment(7, 14));
  EXPECT_EQ(s.u.head(7), Eigen::VectorXd::LinSpaced(7, 1, 7));
  EXPECT_EQ(s.u.tail(7), Eigen::VectorXd::Zero(7));
}

// A file is read the same way except for those torques.
TEST(LoadScene, FillsWhatReadSceneLeavesOpen) {
  int open = 0;
  for (const std::string& path : model_scenes()) {
    SCOPED_TRACE(path);
    const SceneFile read = read_scene(path), loaded = load_scene(path);
    EXPECT_TRUE(loaded.u.allFinite());
    EXPECT_EQ(loaded.q, read.q);
    EXPECT_EQ(loaded.v, read.v);
    EXPECT_EQ(loaded.gravity_robots, read.gravity_robots);
    Eigen::VectorXd u = loaded.u;
    for (const int r : read.gravity_robots) {
      const Robot& robot = read.scene.robots[r];
      EXPECT_TRUE(read.u.segment(robot.idx_u, robot.model->nu()).array().isNaN().all());
      u.segment(robot.idx_u, robot.model->nu()) = read.u.segment(robot.idx_u, robot.model->nu());
      open += robot.model->nu();
    }
    for (Eigen::Index i = 0; i < u.size(); ++i) EXPECT_TRUE(u[i] == read.u[i] || std::isnan(u[i])) << i;
  }
  EXPECT_GT(open, 0);
}

}  // namespace
}  // namespace manycontact::test
