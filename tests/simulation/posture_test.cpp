// Singular configurations between two states are found, and nearly singular ones are not mistaken for them.

#include "manycontact/simulation/posture.hpp"

#include <gtest/gtest.h>

#include "simulation/scenes.hpp"

namespace manycontact::test {
namespace {

// Two links of 1 m and 0.8 m in the plane across y have their tip fixed in x and z: det J = 0.8 sin q2.
Scene two_links(const SE3<double>& base = {}) {
  Model model;
  for (int k = 0; k < 2; ++k) {
    Joint joint;
    joint.name = "j" + std::to_string(k);
    joint.type = JointType::kRevolute;
    joint.axis = Vec3<double>::UnitY();
    joint.parent = k - 1;
    if (k == 1) joint.placement.p = {1, 0, 0};
    joint.inertia = Inertia<double>::from_com(1, {0.4, 0, 0}, 0.1 * Mat3<double>::Identity());
    joint.lower = joint.upper = joint.velocity_limit = joint.effort_limit = Eigen::VectorXd::Zero(1);
    model.joints.push_back(joint);
  }
  finalize(model);
  Scene scene;
  add_robot(scene, "arm" + std::to_string(scene.nrobots()), std::make_shared<const Model>(model), base);
  Contact tip;
  tip.name = "tip";
  tip.type = ContactType::k2D;
  tip.reference_frame = ReferenceFrame::kWorld;
  tip.A = {0, 1, SE3<double>{Mat3<double>::Identity(), {0.8, 0, 0}}};
  add_contact(scene, tip);
  return scene;
}

ClosestPosture closest_on_the_way(const Scene& scene, const std::vector<Eigen::Vector2d>& way, std::size_t& step) {
  PostureData data(scene);
  ClosestPosture closest;
  for (std::size_t k = 0; k < way.size(); ++k) {
    const ClosestPosture at = follow_posture(scene, {1}, way[k], data);
    if (at.share < closest.share) closest = at, step = k;
  }
  return closest;
}

TEST(Posture, StraightArmsBetweenTwoStates) {
  const Scene scene = two_links();
  for (double h : {0.1, 0.01, 0.003}) {
    std::vector<Eigen::Vector2d> way;
    for (int k = 0; k < 2 / h; ++k) way.push_back({0.3 + 0.1 * k * h, -1.03 + (k + 0.4) * h});
    std::size_t step = 0;
    const ClosestPosture closest = closest_on_the_way(scene, way, step);
    EXPECT_LE(closest.share, 0.1 * h) << h;
    const double q2 = way[step - 1][1] + closest.at * (way[step][1] - way[step - 1][1]);
    EXPECT_NEAR(q2, 0, 0.05 * h);
    EXPECT_LT(way[step - 1][1] * way[step][1], 0);  // no state is singular itself
  }
}

// A motion passes close by and back, or along: the result is as near as the motion is.
TEST(Posture, PassingBy) {
  const Scene scene = two_links();
  std::vector<Eigen::Vector2d> there, along;
  for (int k = 0; k <= 200; ++k) there.push_back({0.3, 1.2 - 0.01 * std::min(k, 200 - k)});
  for (int k = 0; k <= 200; ++k) along.push_back({0.05 * k, 1.2});
  std::size_t step = 0;
  const ClosestPosture near = closest_on_the_way(scene, there, step);
  EXPECT_GT(near.share, 0.1);  // q2 = 0.2
  EXPECT_LT(near.share, 0.4);
  EXPECT_NEAR(static_cast<double>(step), 100, 1);
  EXPECT_GT(closest_on_the_way(scene, along, step).share, 0.98);
}

// Contacts that open and close start from scratch; without contacts nothing is near.
TEST(Posture, ContactsThatSwitch) {
  const Scene scene = two_links();
  PostureData data(scene);
  for (double q2 : {0.5, 0.4}) EXPECT_GT(follow_posture(scene, {1}, Eigen::Vector2d(0, q2), data).share, 0.5);
  for (double q2 : {0.1, -0.1}) EXPECT_EQ(follow_posture(scene, {0}, Eigen::Vector2d(0, q2), data).share, 1);
  for (double q2 : {-0.4, -0.5}) EXPECT_GT(follow_posture(scene, {1}, Eigen::Vector2d(0, q2), data).share, 0.5);
}

// Each robot of a herd is treated separately: one of them passes.
TEST(Posture, OneOfManyIslands) {
  Scene scene = two_links();
  const auto model = scene.robots[0].model;
  for (int r = 1; r < 4; ++r) {
    add_robot(scene, "arm" + std::to_string(r), model);
    Contact tip = scene.contacts[0];
    tip.name += std::to_string(r);
    tip.A.robot = r;
    add_contact(scene, tip);
  }
  PostureData data(scene);
  ClosestPosture closest;
  for (double q2 = -0.55; q2 < 0.6; q2 += 0.1) {
    Eigen::VectorXd q = Eigen::VectorXd::Constant(8, 1.0);
    q[5] = q2;
    const ClosestPosture at = follow_posture(scene, {1, 1, 1, 1}, q, data);
    if (at.share < closest.share) closest = at;
  }
  EXPECT_LE(closest.share, 0.02);
}

}  // namespace
}  // namespace manycontact::test
