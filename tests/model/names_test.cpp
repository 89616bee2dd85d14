// A scene's coordinates have names and numbers.

#include <gtest/gtest.h>

#include <stdexcept>

#include "manycontact/model/scene.hpp"

namespace manycontact::test {
namespace {

Joint joint(const std::string& name, JointType type, int parent) {
  Joint j;
  j.name = name;
  j.type = type;
  j.parent = parent;
  return j;
}

// Returns three robots: free with a knee and a sledge, fixed with a planar and a floating joint, and a stone.
Scene three_robots() {
  Model free, fixed, stone;
  free.floating_base = true;
  free.joints = {joint("root", JointType::kFloating, -1), joint("knee", JointType::kRevolute, 0),
                 joint("sledge", JointType::kPrismatic, 0)};
  free.notes.locked = {"neck"};
  fixed.joints = {joint("plate", JointType::kPlanar, -1), joint("kite", JointType::kFloating, 0)};
  fixed.notes.merged = {"stand"};
  Scene scene;
  for (Model* model : {&free, &fixed, &stone}) {
    finalize(*model);
    add_robot(scene, "r" + std::to_string(scene.nrobots()), std::make_shared<Model>(*model));
  }
  return scene;
}

using Names = std::vector<std::string>;

TEST(Names, EveryCoordinateHasOne) {
  const Scene scene = three_robots();
  EXPECT_EQ(configuration_names(scene),
            (Names{"r0/root[0]", "r0/root[1]", "r0/root[2]", "r0/root[3]", "r0/root[4]", "r0/root[5]", "r0/root[6]",
                   "r0/knee", "r0/sledge", "r1/plate[0]", "r1/plate[1]", "r1/plate[2]", "r1/kite[0]", "r1/kite[1]",
                   "r1/kite[2]", "r1/kite[3]", "r1/kite[4]", "r1/kite[5]", "r1/kite[6]"}));
  EXPECT_EQ(velocity_names(scene),
            (Names{"r0/root[0]", "r0/root[1]", "r0/root[2]", "r0/root[3]", "r0/root[4]", "r0/root[5]", "r0/knee",
                   "r0/sledge", "r1/plate[0]", "r1/plate[1]", "r1/plate[2]", "r1/kite[0]", "r1/kite[1]", "r1/kite[2]",
                   "r1/kite[3]", "r1/kite[4]", "r1/kite[5]"}));
  EXPECT_EQ(torque_names(scene),
            (Names{"r0/knee", "r0/sledge", "r1/plate[0]", "r1/plate[1]", "r1/plate[2]", "r1/kite[0]", "r1/kite[1]",
                   "r1/kite[2]", "r1/kite[3]", "r1/kite[4]", "r1/kite[5]"}));
  EXPECT_EQ(configuration_names(scene).size(), static_cast<std::size_t>(scene.nq));
  EXPECT_EQ(velocity_names(scene).size(), static_cast<std::size_t>(scene.nv));
  EXPECT_EQ(torque_names(scene).size(), static_cast<std::size_t>(scene.nu));
}

// The first coordinate of a joint has the joint's name.
TEST(Names, IndicesFindThem) {
  const Scene scene = three_robots();
  const auto expect_at = [](const Names& names, int index, const std::string& name) {
    ASSERT_LT(static_cast<std::size_t>(index), names.size());
    EXPECT_TRUE(names[index] == name || names[index] == name + "[0]") << names[index] << " for " << name;
  };
  for (const Robot& robot : scene.robots)
    for (const Joint& j : robot.model->joints) {
      const std::string name = robot.name + "/" + j.name;
      expect_at(configuration_names(scene), q_index(scene, robot.name, j.name), name);
      expect_at(velocity_names(scene), v_index(scene, robot.name, j.name), name);
      if (name != "r0/root") expect_at(torque_names(scene), u_index(scene, robot.name, j.name), name);
    }
}

TEST(Names, UnknownOnesAreRefusedWithASuggestion) {
  const Scene scene = three_robots();
  const auto expect_refused = [&](const std::string& robot, const std::string& name, const std::string& says) {
    for (const auto index : {q_index, v_index, u_index}) {
      try {
        index(scene, robot, name);
        ADD_FAILURE() << robot << "/" << name << " was found";
      } catch (const std::invalid_argument& error) {
        EXPECT_NE(std::string(error.what()).find(says), std::string::npos) << error.what();
      }
    }
  };
  expect_refused("r9", "knee", "there is no robot 'r9', expected one of 'r0', 'r1', 'r2'");
  expect_refused("r0", "kneee", "robot 'r0': the robot has no joint 'kneee', expected one of 'root', 'knee', 'sledge'");
  expect_refused("r0", "neck", "robot 'r0': joint 'neck' is locked");
  expect_refused("r1", "stand", "robot 'r1': joint 'stand' is fixed");
  expect_refused("r2", "knee", "there are no names to choose from");
}

TEST(Names, AFloatingBaseHasNoTorques) {
  const Scene scene = three_robots();
  EXPECT_THROW(u_index(scene, "r0", "root"), std::invalid_argument);
  EXPECT_EQ(u_index(scene, "r0", "knee"), 0);
  EXPECT_EQ(u_index(scene, "r1", "kite"), 5);  // a floating joint elsewhere is actuated
}

}  // namespace
}  // namespace manycontact::test
