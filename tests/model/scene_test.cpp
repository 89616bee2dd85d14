// add_robot, attach and add_contact accept or refuse input, and store it correctly.

#include "manycontact/model/scene.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>

#include "spatial/compare.hpp"
#include "support/random.hpp"

namespace manycontact::test {
namespace {

/// Returns the message of std::invalid_argument that `action` throws; empty if it throws nothing.
template <class Action>
std::string refusal(Action&& action) {
  try {
    action();
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

void expect_says(const std::string& message, const std::string& part) {
  EXPECT_NE(message.find(part), std::string::npos) << "'" << message << "'\nshould say: " << part;
}

Frame frame(const std::string& name, int joint, const SE3<double>& placement = {}) {
  Frame f;
  f.name = name;
  f.joint = joint;
  f.placement = placement;
  return f;
}

// The scene has a table on a fixed base with a lid on a hinge, and a free ball.
class SceneOfTwo : public testing::Test {
 protected:
  SceneOfTwo() {
    Model table;
    table.joints.resize(1);
    table.joints[0].name = "hinge";
    table.frames = {frame("top", -1, random_placement(rng)), frame("leg", -1), frame("lid", 0), frame("handle", 0)};
    Model ball;
    ball.floating_base = true;
    ball.joints.resize(1);
    ball.joints[0].name = "root";
    ball.joints[0].type = JointType::kFloating;
    ball.frames = {frame("ball", 0)};
    finalize(table);
    finalize(ball);
    add_robot(scene, "table", std::make_shared<Model>(table), random_placement(rng));
    add_robot(scene, "ball", std::make_shared<Model>(ball));
    other_table = add_robot(scene, "other", scene.robots[0].model, random_placement(rng));
  }
  Contact between(const Attachment& A, const Attachment& B) const {
    Contact c;
    c.name = "c";
    c.A = A;
    c.B = B;
    return c;
  }
  Attachment on(const std::string& robot, const std::string& frame) const { return attach(scene, robot, frame); }
  std::string refused(const Contact& c) {
    const std::size_t before = scene.contacts.size();
    const std::string message = refusal([&] { add_contact(scene, c); });
    EXPECT_EQ(scene.contacts.size(), before + message.empty());
    EXPECT_EQ(scene.contact_index.size(), scene.contacts.size());
    return message;
  }

  std::mt19937 rng{5};
  Scene scene;
  int other_table = -1;
};

// ---- robots

TEST_F(SceneOfTwo, ARobotNeedsAFinalizedModel) {
  Model model = *scene.robots[0].model;
  const auto add = [&] { add_robot(scene, "r", std::make_shared<Model>(model)); };
  model.joints.push_back(model.joints[0]);  // after finalize
  expect_says(refusal(add), "robot 'r' has a model that was not finalized");
  model.armature.resize(0);
  finalize(model);
  EXPECT_EQ(refusal(add), "");

  Model fresh;
  EXPECT_FALSE(is_finalized(fresh));  // even without joints
  finalize(fresh);
  EXPECT_TRUE(is_finalized(fresh));
  fresh.joints.resize(1);
  EXPECT_FALSE(is_finalized(fresh));
  finalize(fresh);
  fresh.joints[0].type = JointType::kPlanar;
  EXPECT_FALSE(is_finalized(fresh));
  fresh.joints[0].type = JointType::kPrismatic;  // of as many coordinates
  EXPECT_TRUE(is_finalized(fresh));
  fresh.armature.resize(0);
  EXPECT_FALSE(is_finalized(fresh));
}

TEST_F(SceneOfTwo, RobotsThatAreRefusedLeaveNoTrace) {
  const auto model = scene.robots[1].model;
  expect_says(refusal([&] { add_robot(scene, "ball", model); }), "robot 'ball' exists already");
  expect_says(refusal([&] { add_robot(scene, "r", nullptr); }), "robot 'r' has no model");
  SE3<double> base;
  base.p.z() = kNaN;
  expect_says(refusal([&] { add_robot(scene, "r", model, base); }), "robot 'r' has a base that is not finite");
  EXPECT_EQ(scene.nrobots(), 3);
  EXPECT_EQ(scene.robot_index.size(), 3u);
  EXPECT_EQ(add_robot(scene, "r", model), 3);
}

// ---- attachments

TEST_F(SceneOfTwo, AttachRemembersTheFrame) {
  const SE3<double> offset = random_placement(rng);
  const Attachment at = attach(scene, "table", "top", offset);
  EXPECT_EQ(at.frame, "top");
  EXPECT_EQ(at.robot, 0);
  EXPECT_EQ(at.joint, -1);
  EXPECT_EQ(difference_of(at.placement, scene.robots[0].model->frames[0].placement * offset), 0);
}

TEST_F(SceneOfTwo, AttachSuggestsNames) {
  expect_says(refusal([&] { on("tabel", "top"); }),
              "there is no robot 'tabel', expected one of 'table', 'ball', 'other'");
  expect_says(refusal([&] { on("table", "lit"); }), "robot 'table' has no frame 'lit', expected one of 'top', 'leg'");
  Model many;
  for (int i = 0; i < 20; ++i) many.frames.push_back(frame("link_" + std::to_string(100 + i), -1));
  finalize(many);
  add_robot(scene, "many", std::make_shared<Model>(many));
  expect_says(refusal([&] { on("many", "lnik_117"); }),
              "robot 'many' has no frame 'lnik_117', did you mean 'link_117'?");
}

// ---- contacts

TEST_F(SceneOfTwo, AnImmovableBodyIsTheWorld) {
  const SE3<double> offset = random_placement(rng);
  EXPECT_EQ(add_contact(scene, between(on("ball", "ball"), attach(scene, "table", "top", offset))), 0);
  const Attachment& B = scene.contacts[0].B;
  EXPECT_EQ(B.robot, -1);
  EXPECT_EQ(B.joint, -1);
  const SE3<double> expected = scene.robots[0].base * (scene.robots[0].model->frames[0].placement * offset);
  EXPECT_LE(difference_of(B.placement, expected), 8 * kEps);
  EXPECT_EQ(B.frame, "table/top");

  Contact moving = between(on("ball", "ball"), on("table", "lid"));
  moving.name = "lid";
  add_contact(scene, moving);
  EXPECT_EQ(scene.contacts[1].B.robot, 0);
  EXPECT_EQ(scene.contacts[1].B.frame, "lid");
}

// A's axes are those of the rows: exchanged with B it would be another contact.
TEST_F(SceneOfTwo, AnImmovableAKeepsItsPlace) {
  add_contact(scene, between(on("table", "top"), on("ball", "ball")));
  const Contact& c = scene.contacts[0];
  EXPECT_EQ(c.A.robot, 0);
  EXPECT_EQ(c.A.joint, -1);
  EXPECT_EQ(c.B.robot, 1);
}

TEST_F(SceneOfTwo, BodiesThatCannotBeHeldTogether) {
  const Attachment world, lid = on("table", "lid"), top = on("table", "top");
  expect_says(refused(between(world, lid)), "contact 'c' has frame A in the world");
  expect_says(refused(between(lid, lid)), "contact 'c' ties frame 'lid' of robot 'table' to itself");
  expect_says(
      refused(between(lid, on("table", "handle"))),
      "contact 'c' ties frame 'lid' of robot 'table' to frame 'handle' of robot 'table', which are on one body");
  expect_says(refused(between(top, on("table", "leg"))), "which are on one body");
  for (const Attachment& still : {world, on("other", "top")})
    expect_says(refused(between(top, still)),
                "contact 'c' fixes frame 'top' of robot 'table', which cannot move, to the world");
  expect_says(refused(between({0, 0, {}}, {0, 0, random_placement(rng)})), "ties joint 'hinge' of robot 'table'");
  expect_says(refused(between({0, -1, {}}, world)), "fixes the base of robot 'table', which cannot move");
  expect_says(refused(between({3, 0, {}}, world)), "names robot 3, expected a number from -1 to 2");
  expect_says(refused(between({0, 1, {}}, world)), "names joint 1, expected a number from -1 to 0");
  expect_says(refused(between({1, -1, {}}, world)), "names the fixed base of robot 'ball', which has a floating base");
  EXPECT_EQ(refused(between(lid, on("other", "lid"))), "");
  expect_says(refused(between(lid, world)), "contact 'c' exists already");
}

TEST_F(SceneOfTwo, NumbersAreFinite) {
  const Contact good = between(on("table", "lid"), {});
  for (double bad : {kNaN, std::numeric_limits<double>::infinity()}) {
    Contact c = good;
    c.A.placement.p.x() = bad;
    expect_says(refused(c), "contact 'c' has a placement that is not finite");
    c = good;
    c.B.placement.R(1, 2) = bad;
    expect_says(refused(c), "contact 'c' has a placement that is not finite");
    c = good;
    c.beta = bad;
    expect_says(refused(c), "contact 'c' has gains that are not finite");
    c = good;
    c.axis.y() = bad;
    expect_says(refused(c), "contact 'c' has an axis that is not finite");
  }
}

TEST_F(SceneOfTwo, AxesAreNormalisedOrZero) {
  Contact c = between(on("table", "lid"), {});
  const Vec3<double> direction(0, 0.6, 0.8);
  for (double length : {0.0, 1e-200, 1e-16, 0.99e-9}) {
    c.axis = length * direction;
    expect_says(refused(c), "contact 'c' has a zero axis");
  }
  for (double length : {1.01e-9, 1.0, 5.0, 1e300}) {
    c.axis = length * direction;
    c.name = "c" + std::to_string(scene.contacts.size());
    EXPECT_EQ(refused(c), "");
    EXPECT_LE(difference_of(scene.contacts.back().axis, direction), 4 * kEps);
  }
}

}  // namespace
}  // namespace manycontact::test
