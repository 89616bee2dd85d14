// Scenes are loaded from files with the torques of u="gravity".

#include "manycontact/analysis/load_scene.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "manycontact/algorithm/rigid_body.hpp"
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

std::vector<Unbalanced> unbalanced(const SceneFile& file) {
  std::vector<Unbalanced> out;
  (void)quasi_static(file.scene, file.q, &out);
  return out;
}

constexpr char kHumanoid[] = R"(<robot name="h" urdf="humanoid.urdf" base="floating" u="gravity"/>)";

// No torques keep a humanoid at rest in the air, or on one point; torques do so on its soles, and without gravity.
TEST(LoadScene, ReportsRobotsThatNoTorquesKeepAtRest) {
  const auto loaded = [](const std::string& head, const std::string& inside) {
    return load_text("<scene" + head + ">\n" + kHumanoid + inside + "</scene>");
  };
  const auto sole = [](const std::string& type) {
    return "<contact name='left' type='" + type + "' frame='h/left_sole'/>";
  };
  const SceneFile in_air = loaded("", "");
  ASSERT_EQ(unbalanced(in_air).size(), 1u);
  EXPECT_EQ(unbalanced(in_air)[0].dof, 2);
  EXPECT_NEAR(unbalanced(in_air)[0].force, 9.81 * total_mass(in_air.scene), 1e-6);
  EXPECT_FALSE(unbalanced(in_air)[0].angular);
  ASSERT_EQ(in_air.findings.size(), 1u);
  EXPECT_EQ(in_air.findings[0].kind, "rest");
  EXPECT_EQ(in_air.findings[0].name, "h/root[2]");
  EXPECT_EQ(in_air.findings[0].line, 2);
  EXPECT_NE(in_air.findings[0].text.find("N remains"), std::string::npos) << in_air.findings[0].text;
  const SceneFile on_a_point = loaded("", sole("3d"));
  ASSERT_EQ(on_a_point.findings.size(), 1u);
  EXPECT_TRUE(unbalanced(on_a_point)[0].angular);
  EXPECT_EQ(loaded(" gravity='0 0 0'", "").findings.size(), 0u);
  EXPECT_EQ(loaded(" gravity='0 0 0'", "<push name='p' frame='h/left_sole' force='0 0 5'/>").findings.size(), 1u);
  EXPECT_EQ(loaded("", sole("6d")).findings.size(), 0u);
  EXPECT_EQ(loaded("", sole("6d") + "<push name='p' frame='h/left_hand' force='0 9 5'/>").findings.size(), 0u);
}

// The robot that floats is not one with u="gravity". Copies are reported each.
TEST(LoadScene, ReportsOnlyRobotsWithGravityTorques) {
  const std::string box = R"(<robot name="b" urdf="box.urdf" base="floating" copies="3")";
  EXPECT_EQ(load_text("<scene>" + box + "/></scene>").findings.size(), 0u);
  const SceneFile file = load_text("<scene>" + box + " u=\"gravity\"/></scene>");
  ASSERT_EQ(file.findings.size(), 3u);
  EXPECT_EQ(file.findings[2].name, "b2/root[2]");
}

// The scenes of the models are at rest. A light pendulum on a heavy cart counts as much as a heavy one.
TEST(LoadScene, LoadsAreComparedWithThoseOfEachCoordinate) {
  for (const std::string& path : model_scenes())
    for (const Finding& finding : load_scene(path).findings) EXPECT_NE(finding.kind, "rest") << path << finding.text;
  for (const double mass : {1e-6, 1.0}) {
    Model cart;
    Joint slide, hinge;
    slide.name = "x", slide.type = JointType::kPrismatic, slide.axis = Vec3<double>::UnitX();
    slide.inertia = Inertia<double>::from_com(10, Vec3<double>::Zero(), Mat3<double>::Identity());
    hinge.name = "pole", hinge.axis = Vec3<double>::UnitY(), hinge.parent = 0, hinge.actuated = false;
    hinge.inertia = Inertia<double>::from_com(mass, Vec3<double>(0, 0, 0.5), 1e-3 * mass * Mat3<double>::Identity());
    cart.joints = {slide, hinge};
    finalize(cart);
    Scene scene;
    add_robot(scene, "r", std::make_shared<const Model>(cart));
    for (const double angle : {0.4, 1e-3, M_PI, 0.0}) {
      std::vector<Unbalanced> found;
      (void)quasi_static(scene, Eigen::Vector2d(0, angle), &found);
      ASSERT_EQ(found.size(), std::sin(angle) > 1e-9 ? 1u : 0u) << mass << " " << angle;
      if (found.empty()) continue;
      EXPECT_EQ(found[0].dof, 1);
      EXPECT_NEAR(found[0].force, 9.81 * mass * 0.5 * std::sin(angle), 1e-9 * mass);
      EXPECT_TRUE(found[0].angular);
    }
  }
}

}  // namespace
}  // namespace manycontact::test
