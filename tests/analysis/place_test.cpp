// Inverse kinematics of scenes meets goals of every kind from nearby, keeps limits, and shares what cannot be met by
// weights. Public robots are placed on their soles, rings hand in hand, and scenes by <pose>.

#include "manycontact/analysis/place.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "manycontact/algorithm/configuration.hpp"
#include "manycontact/algorithm/rigid_body.hpp"
#include "manycontact/analysis/findings.hpp"
#include "manycontact/analysis/load_scene.hpp"
#include "manycontact/detail/contact/reference.hpp"
#include "manycontact/io/urdf.hpp"
#include "support/folder.hpp"
#include "support/random.hpp"
#include "support/scenes.hpp"

namespace manycontact::test {
namespace {

using Eigen::VectorXd;

constexpr double kFound = 1e-9;  // m, rad: given by the issue
constexpr auto kOpen = std::nullopt;

double nearest_angle(double x) { return std::remainder(x, 2 * M_PI); }

// Expects q within the limits, to the last bit.
void expect_within_limits(const Scene& scene, const VectorXd& q) {
  for (const Robot& robot : scene.robots)
    for (const Joint& joint : robot.model->joints)
      for (int k = 0; joint.type != JointType::kFloating && k < joint.nv(); ++k) {
        if (joint.lower.size() != joint.nv() || !(joint.lower[k] < joint.upper[k])) continue;
        const double x = q[robot.idx_q + joint.idx_q + k];
        EXPECT_GE(x, joint.lower[k]) << robot.name << "/" << joint.name;
        EXPECT_LE(x, joint.upper[k]) << robot.name << "/" << joint.name;
      }
}

// Contains a state within limits, and another one `size` away from it.
struct Nearby {
  Nearby(const Scene& scene, unsigned seed, double size) {
    std::mt19937 rng(seed);
    wanted = manycontact::random_configuration(scene, rng);
    start = integrate(scene, wanted, random_vector(scene.nv, rng, size));
    data = std::make_unique<RigidBodyData>(scene);
    forward_kinematics(scene, wanted, *data);
  }
  VectorXd wanted, start;
  std::unique_ptr<RigidBodyData> data;
};

SceneFile two_robots() {
  return load_text(
      "<scene><robot name=\"h\" urdf=\"humanoid.urdf\" base=\"floating\"/>"
      "<robot name=\"a\" urdf=\"arm.urdf\" xyz=\"1 2 0\"/><robot name=\"b\" urdf=\"box.urdf\" "
      "base=\"floating\"/></scene>");
}

TEST(Place, MeetsGoalsOfEveryKind) {
  const SceneFile file = two_robots();
  const Scene& scene = file.scene;
  for (unsigned seed = 1; seed <= 10; ++seed) {
    const Nearby near(scene, seed, 0.1);
    const Attachment left = find_frame(scene, "h/left_hand"), right = find_frame(scene, "h/right_sole"),
                     tool = find_frame(scene, "a/tool"), crate = find_frame(scene, "b/crate");
    const auto at = [&](const Attachment& frame) { return frame_placement(scene, *near.data, frame); };
    const Vec3<double> hand = at(left).p, c = center_of_mass(RigidBodies(scene), *near.data);
    const Mat3<double> R = at(tool).R;
    const double roll = std::atan2(R(2, 1), R(2, 2)), pitch = std::asin(-R(2, 0));
    const std::vector<Goal> goals = {
        pose_goal(left, Partial{hand[0], kOpen, hand[2]}, {}, 3),
        pose_goal(right, at(right)),
        pose_goal(tool, Partial{}, Partial{roll, pitch, kOpen}, 0.5),
        pose_goal(tool, Partial{at(tool).p[0], kOpen, kOpen}, {kOpen, kOpen, kOpen}),
        pose_goal(crate, Partial{}, Partial{0.3, -0.4, 2.0}),
        center_of_mass_goal(scene, {c[0], c[1], kOpen}, "", 2),
        joint_goal(scene, "h/left_knee", near.wanted[q_index(scene, "h", "left_knee")]),
    };
    const PlacedScene found = place(scene, near.start, goals);
    EXPECT_TRUE(found.met(kFound)) << seed;
    EXPECT_LE(found.iterations, 20) << seed;
    expect_within_limits(scene, found.q);

    // checked again
    RigidBodyData data(scene);
    forward_kinematics(scene, found.q, data);
    EXPECT_NEAR(frame_placement(scene, data, left).p[0], hand[0], 2 * kFound);
    EXPECT_NEAR(frame_placement(scene, data, left).p[2], hand[2], 2 * kFound);
    EXPECT_LE((frame_placement(scene, data, right).R - at(right).R).norm(), 4 * kFound);
    const Mat3<double> T = frame_placement(scene, data, tool).R;
    EXPECT_NEAR(nearest_angle(std::atan2(T(2, 1), T(2, 2)) - roll), 0, 1e-7 / std::cos(pitch));
    EXPECT_NEAR(std::asin(-T(2, 0)), pitch, 1e-7);
    const Mat3<double> C = frame_placement(scene, data, crate).R;
    EXPECT_NEAR(std::atan2(C(1, 0), C(0, 0)), 2.0, 1e-7);
    EXPECT_NEAR(center_of_mass(RigidBodies(scene), data)[1], c[1], 2 * kFound);
  }
}

// Goals are angles alone: yaw, and pitch with yaw.
TEST(Place, MeetsSingleAngles) {
  const SceneFile file = two_robots();
  const Attachment crate = find_frame(file.scene, "b/crate");
  const VectorXd q = neutral(file.scene);
  const auto angles = [&](const Partial& rpy) {
    const PlacedScene found = place(file.scene, q, {pose_goal(crate, Partial{}, rpy)});
    EXPECT_TRUE(found.met(kFound));
    RigidBodyData data(file.scene);
    forward_kinematics(file.scene, found.q, data);
    const Mat3<double> R = frame_placement(file.scene, data, crate).R;
    return Vec3<double>(std::atan2(R(2, 1), R(2, 2)), std::asin(-R(2, 0)), std::atan2(R(1, 0), R(0, 0)));
  };
  EXPECT_NEAR(angles({kOpen, kOpen, 1.1})[2], 1.1, 2 * kFound);
  EXPECT_NEAR(angles({kOpen, 0.7, 3.0})[1], 0.7, 2 * kFound);
  EXPECT_NEAR(angles({kOpen, 0.7, 3.0})[2], 3.0, 2 * kFound);
  EXPECT_NEAR(angles({-2, kOpen, kOpen})[0], -2, 2 * kFound);
  EXPECT_NEAR(angles({3.1, 0, kOpen})[0], 3.1, 2 * kFound);  // rotated upside down
  EXPECT_NEAR(std::abs(angles({M_PI, 0, kOpen})[0]), M_PI, 2 * kFound);
}

// Contacts have all types, between robots and with the world, in all axes.
TEST(Place, ClosesContacts) {
  for (unsigned seed = 1; seed <= 12; ++seed) {
    std::mt19937 rng(seed);
    SceneOptions options;
    options.errors = false;
    RandomScene s = random_scene(rng, options);
    std::vector<Goal> goals;
    for (const Contact& contact : s.scene.contacts) goals.push_back(contact_goal(s.scene, contact.name));
    const VectorXd start = integrate(s.scene, s.q, random_vector(s.scene.nv, rng, 0.05));
    const std::vector<char> all(goals.size(), 1);
    EXPECT_FALSE(placement_errors(s.scene, start, all).empty()) << seed;
    const PlacedScene found = place(s.scene, start, goals);
    EXPECT_TRUE(found.met(kFound)) << seed;
    EXPECT_LE(found.iterations, 25) << seed;
    EXPECT_TRUE(placement_errors(s.scene, found.q, all).empty()) << seed;
  }
}

// ---- limits --------------------------------------------------------------------------------------------------------

// A hand has a goal beyond its reach: the solution is a minimum among the configurations within limits.
TEST(Place, ReachesAsFarAsLimitsAllow) {
  const SceneFile file = two_robots();
  const Scene& scene = file.scene;
  for (unsigned seed = 1; seed <= 6; ++seed) {
    const Nearby near(scene, seed, 0.3);
    const std::vector<Goal> goals = {
        pose_goal(find_frame(scene, "a/tool"), SE3<double>{Mat3<double>::Identity(), {4, 1 - 2.0 * seed, 0.5}}),
        joint_goal(scene, "h/left_knee", 4),
        joint_goal(scene, "h/right_knee", -4),
    };
    PlaceOptions options;
    options.iterations = 1000;
    const PlacedScene found = place(scene, near.start, goals, options);
    EXPECT_FALSE(found.met(1e-3));
    expect_within_limits(scene, found.q);
    const Joint& knee = scene.robots[0].model->joints[scene.robots[0].model->find_joint("left_knee")];
    EXPECT_EQ(found.q[q_index(scene, "h", "left_knee")], knee.upper[0]);
    EXPECT_EQ(found.q[q_index(scene, "h", "right_knee")], knee.lower[0]);
    EXPECT_NEAR(found.left[1].angle, 4 - knee.upper[0], 1e-12);

    const auto size = [&](const VectorXd& q) {  // what remains, squared
      PlaceOptions look;
      look.iterations = 0;
      double sum = 0;
      for (const GoalLeft& left : place(scene, q, goals, look).left)
        sum += left.position * left.position + left.angle * left.angle;
      return sum;
    };
    const double least = size(found.q);
    std::mt19937 rng(seed);
    for (int k = 0; k < 200; ++k) {  // place brings these states within the limits
      const VectorXd step = random_vector(scene.nv, rng, 1e-3);
      EXPECT_GT(size(integrate(scene, found.q, step)), least * (1 - 1e-8));
    }
  }
}

TEST(Place, StartsWithinLimits) {
  const SceneFile file = two_robots();
  VectorXd q = neutral(file.scene);
  q[q_index(file.scene, "h", "left_knee")] = -7;
  const PlacedScene found = place(file.scene, q, {});
  expect_within_limits(file.scene, found.q);
  EXPECT_EQ(found.iterations, 0);
  EXPECT_TRUE(found.met());
}

TEST(Place, ContradictingGoalsShareByWeight) {
  const SceneFile file = load_text("<scene><robot name=\"b\" urdf=\"box.urdf\" base=\"floating\"/></scene>");
  const Attachment crate = find_frame(file.scene, "crate");
  const PlacedScene found =
      place(file.scene, neutral(file.scene),
            {pose_goal(crate, Partial{1.0, kOpen, kOpen}, {}, 3), pose_goal(crate, Partial{5.0, kOpen, kOpen}, {}, 1),
             pose_goal(crate, Partial{kOpen, 2.0, kOpen})});
  EXPECT_NEAR(found.q[0], 2, 1e-6);
  EXPECT_NEAR(found.left[0].position, 1, 1e-6);
  EXPECT_NEAR(found.left[1].position, 3, 1e-6);
  EXPECT_LE(found.left[2].position, 1e-8);  // a billionth of a step remains due to the damping
}

TEST(Place, SaysWhatIsWrong) {
  const SceneFile file = two_robots();
  const Scene& scene = file.scene;
  const VectorXd q = neutral(scene);
  const auto refused = [&](Goal goal) -> std::string {
    try {
      (void)place(scene, q, {std::move(goal)});
    } catch (const std::invalid_argument& e) {
      return e.what();
    }
    return "";
  };
  Goal goal = joint_goal(scene, "h/left_knee", 0.3);
  EXPECT_EQ(refused(goal), "");
  goal.weight = 0;
  EXPECT_NE(refused(goal).find("'h/left_knee' has a weight that is not a finite number above 0"), std::string::npos);
  EXPECT_NE(refused(joint_goal(scene, "h/root", 0.3)).find("several coordinates"), std::string::npos);
  EXPECT_NE(refused(joint_goal(scene, "h/left_knee", kNaN)).find("not finite"), std::string::npos);
  EXPECT_NE(refused(pose_goal({-1, -1, {}}, SE3<double>{})).find("belongs to no frame"), std::string::npos);
  EXPECT_NE(refused(pose_goal({7, 0, {}}, SE3<double>{})).find("belongs to no frame"), std::string::npos);
  goal = Goal();
  goal.target = Goal::Target::kContact;
  goal.contact = 3;
  EXPECT_NE(refused(goal).find("belongs to no contact"), std::string::npos);
  EXPECT_THROW((void)contact_goal(scene, "left"), std::invalid_argument);
  EXPECT_THROW((void)joint_goal(scene, "h/left_nee", 1), std::invalid_argument);
  EXPECT_THROW((void)center_of_mass_goal(scene, {}, "x"), std::invalid_argument);
  EXPECT_THROW((void)place(scene, q.head(3), {}), std::invalid_argument);
}

// ---- robots of others ----------------------------------------------------------------------------------------------

struct Feet {
  const char* scene;
  std::vector<const char*> frames;
  bool flat;           // soles, else points
  double lower = 0.1;  // the trunk, of the legs' length
};

const std::vector<Feet>& feet() {
  static const std::vector<Feet> all = {
      {"anymal", {"LF_FOOT", "RF_FOOT", "LH_FOOT", "RH_FOOT"}, false},
      {"atlas_convex_hull", {"l_foot", "r_foot"}, true},
      {"b1", {"FR_foot", "FL_foot", "RR_foot", "RL_foot"}, false},
      {"cassie", {"left_toe", "right_toe"}, true},
      {"g1_29dof", {"left_ankle_roll_link", "right_ankle_roll_link"}, true},
      {"h1", {"left_ankle_link", "right_ankle_link"}, true},
      {"humanoid", {"left_foot", "right_foot"}, true},
      {"icub_reduced", {"l_sole", "r_sole"}, true},
      {"icubgenova11", {"l_sole", "r_sole"}, true},
      {"mini_cheetah", {"toe_fr", "toe_fl", "toe_hr", "toe_hl"}, false},
      // upright: a crouch from neutral ends at a minimum, with its knees and the rotation of its thighs at limits
      {"r2b_dynamics", {"r2/left_leg_foot", "r2/right_leg_foot"}, true, 0},
      {"romeo_small", {"l_sole", "r_sole"}, true},
      {"valkyrie", {"leftFoot", "rightFoot"}, true},
  };
  return all;
}

// From neutral, the feet go to the ground, soles as level as at neutral; the trunk goes lower by a tenth of the legs
// and leans.
TEST(PlacePublicRobots, StandOnTheirSoles) {
  const std::filesystem::path folder = std::filesystem::path(MANYCONTACT_SHARED_DIR) / "public";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "skipped: " << folder << " is not here";
  for (const Feet& robot : feet()) {
    SCOPED_TRACE(robot.scene);
    SceneFile file = load_scene((folder / (std::string(robot.scene) + ".xml")).string());
    const Scene& scene = file.scene;
    const VectorXd start = neutral(scene);
    RigidBodyData data(scene);
    forward_kinematics(scene, start, data);
    std::vector<Goal> goals;
    double lowest = 0;
    for (const char* name : robot.frames) {
      const Attachment foot = find_frame(scene, std::string("r/") + name);
      const SE3<double> M = frame_placement(scene, data, foot);
      lowest = std::min(lowest, M.p[2]);
      const double roll = std::atan2(M.R(2, 1), M.R(2, 2)), pitch = std::asin(std::clamp(-M.R(2, 0), -1.0, 1.0));
      goals.push_back(pose_goal(foot, Partial{kOpen, kOpen, 0.0},
                                robot.flat ? Partial{roll, pitch, kOpen} : Partial{kOpen, kOpen, kOpen}));
    }
    const std::size_t soles = goals.size();
    const Attachment trunk = find_frame(scene, "r/" + scene.robots[0].model->frames[0].name);
    goals.push_back(pose_goal(trunk, Partial{0.0, 0.0, (robot.lower - 1) * lowest}, Partial{0.0, 0.1, 0.0}));
    const PlacedScene found = place(scene, start, goals, {.iterations = 30});
    for (std::size_t g = 0; g < soles; ++g) {
      EXPECT_LE(found.left[g].position, kFound) << goals[g].name;
      EXPECT_LE(found.left[g].angle, kFound) << goals[g].name;
    }
    EXPECT_LE(found.left.back().position, kFound);
    EXPECT_LE(found.left.back().angle, kFound);
    EXPECT_LE(found.iterations, 30);
    expect_within_limits(scene, found.q);
    RecordProperty(robot.scene, found.iterations);
  }
}

// ---- rings ---------------------------------------------------------------------------------------------------------

TEST(PlaceRing, HandInHand) {
  for (const int n : {4, 16}) {
    SceneFile file = load_edited(kModels + "ring_of_humanoids.xml",
                                 {{"copies=\"16\"", "copies=\"" + std::to_string(n) + "\""}, {"u=\"gravity\" ", ""}});
    const Scene& scene = file.scene;
    std::mt19937 rng(5);
    std::vector<Goal> goals;
    for (const Contact& contact : scene.contacts) goals.push_back(contact_goal(scene, contact.name));
    const VectorXd start = integrate(scene, file.q, random_vector(scene.nv, rng, 0.1));
    const PlacedScene found = place(scene, start, goals);
    EXPECT_TRUE(found.met(kFound)) << n;
    EXPECT_LE(found.iterations, 30) << n;
    expect_within_limits(scene, found.q);
  }
}

// ---- scenes with poses ---------------------------------------------------------------------------------------------

const std::string kCrouch =
    "<robot name=\"h\" urdf=\"humanoid.urdf\" base=\"floating\" u=\"gravity\"/>"
    "<pose frame=\"h/left_sole\" z=\"0\" rpy=\"0 0 0\"/>\n"
    "<pose frame=\"h/right_sole\" z=\"0\" roll=\"0\" pitch=\"0\"/>\n"
    "<pose frame=\"h/pelvis\" xyz=\"0 0 0.7\" rpy=\"0 0.2 0\"/>\n";

TEST(Poses, ArePutInPlaceWhenLoaded) {
  const SceneFile plain = load_text("<scene><robot name=\"h\" urdf=\"humanoid.urdf\" base=\"floating\"/></scene>");
  const std::string trunk = plain.scene.robots[0].model->frames[0].name;
  std::string text = kCrouch;
  text.replace(text.find("h/pelvis"), 8, "h/" + trunk);
  const SceneFile file =
      load_text("<scene>" + text + "<contact name=\"left\" type=\"6d\" frame=\"h/left_sole\"/></scene>");
  ASSERT_EQ(file.poses.size(), 3u);
  RigidBodyData data(file.scene);
  forward_kinematics(file.scene, file.q, data);
  for (const char* foot : {"h/left_sole", "h/right_sole"}) {
    const SE3<double> M = frame_placement(file.scene, data, find_frame(file.scene, foot));
    EXPECT_NEAR(M.p[2], 0, kFound);
    EXPECT_NEAR(M.R(2, 2), 1, kFound);
  }
  EXPECT_NEAR(frame_placement(file.scene, data, find_frame(file.scene, "h/" + trunk)).p[2], 0.7, kFound);
  EXPECT_TRUE(placement_errors(file.scene, file.q, {1}).empty());  // its reference is there
  expect_within_limits(file.scene, file.q);
  EXPECT_GT(file.u.norm(), 1);          // quasi-static there
  ASSERT_EQ(file.findings.size(), 2u);  // the other: it is on its left foot alone, and not in balance
  EXPECT_EQ(file.findings[0].kind, "pose");
  EXPECT_NE(file.findings[0].text.find("q changed most"), std::string::npos) << file.findings[0].text;
}

// Hands in hand and feet on the ground are met at once: poses with consistent="true".
TEST(Poses, AreMetTogetherWithContacts) {
  const SceneFile file = load_text(
      "<scene consistent=\"true\"><robot name=\"h\" urdf=\"humanoid.urdf\" base=\"floating\" copies=\"2\" "
      "spacing=\"0.8\" "
      "xyz=\"0 0 0.75\" rpy=\"0 0 1.57\"/>"
      "<pose frame=\"h/left_sole\" z=\"0\" roll=\"0\" pitch=\"0\"/><pose frame=\"h/right_sole\" z=\"0\" roll=\"0\" "
      "pitch=\"0\"/>"
      "<contact name=\"hold\" type=\"3d\" frame=\"h0/right_hand\" to=\"h1/left_hand\" to_offset=\"0 0 0\"/>"
      "<contact name=\"foot\" type=\"6d\" frame=\"h/left_sole\"/></scene>");
  EXPECT_EQ(file.poses.size(), 4u);
  EXPECT_EQ(file.poses[1].name, "h1/left_sole");
  EXPECT_TRUE(placement_errors(file.scene, file.q, std::vector<char>(file.scene.contacts.size(), 1)).empty());
  RigidBodyData data(file.scene);
  forward_kinematics(file.scene, file.q, data);
  for (const char* foot : {"h0/left_sole", "h1/right_sole"})
    EXPECT_NEAR(frame_placement(file.scene, data, find_frame(file.scene, foot)).p[2], 0, kFound) << foot;
  expect_within_limits(file.scene, file.q);
}

TEST(Poses, ThatCannotBeMetAreRefusedByTheirLine) {
  try {
    (void)load_text(
        "<scene>\n<robot name=\"a\" urdf=\"arm.urdf\"/>\n<pose frame=\"a/tool\" z=\"0.4\"/>\n<pose frame=\"a/tool\"\n "
        "x=\"9\"/></scene>");
    FAIL();
  } catch (const InputError& e) {
    EXPECT_EQ(e.line, 4);
    EXPECT_NE(e.message.find("the pose of 'a/tool' is missed by"), std::string::npos) << e.message;
    EXPECT_NE(e.message.find("expected poses that can be met"), std::string::npos) << e.message;
  }
}

TEST(Poses, ThatLeaveContactsOpenAreRefused) {
  try {
    (void)load_text(
        "<scene\n consistent=\"true\"><robot name=\"b\" urdf=\"box.urdf\" base=\"floating\"/>\n"
        "<pose frame=\"b/crate\" x=\"0\"/><pose frame=\"b/crate\" x=\"0\"/>"
        "<contact name=\"pin\" type=\"3d\" frame=\"b/crate\" xyz=\"3 0 0\"/></scene>");
    FAIL();
  } catch (const InputError& e) {
    EXPECT_EQ(e.line, 2);
    EXPECT_NE(e.message.find("contact 'pin' remains out of place by 2 m"), std::string::npos) << e.message;
  }
}

// A joint without lower and upper limits in its file is free; equal limits of a file fix a joint.
TEST(Place, MissingLimitsAreNone) {
  const auto two_links = [](const std::string& limits) {
    return "<robot name='two'><link name='base'/>"
           "<link name='a'><inertial><origin xyz='0 0 -0.15'/><mass value='1'/><inertia ixx='0.01' ixy='0' ixz='0' "
           "iyy='0.01' iyz='0' izz='0.01'/></inertial></link>"
           "<link name='b'><inertial><origin xyz='0 0 -0.15'/><mass value='1'/><inertia ixx='0.01' ixy='0' ixz='0' "
           "iyy='0.01' iyz='0' izz='0.01'/></inertial></link>"
           "<joint name='hip' type='revolute'><parent link='base'/><child link='a'/><axis xyz='0 1 0'/>"
           "<limit lower='-2' upper='2' velocity='9' effort='9'/></joint>"
           "<joint name='knee' type='revolute'><parent link='a'/><child link='b'/><origin xyz='0 0 -0.3'/>"
           "<axis xyz='0 1 0'/><limit velocity='9' effort='9' " +
           limits + "/></joint></robot>";
  };
  const TemporaryFolder folder;
  const auto placed = [&](const std::string& limits) {
    const std::string path = (folder.path() / "two.urdf").string();
    std::ofstream(path) << two_links(limits);
    Scene scene;
    add_robot(scene, "two", std::make_shared<const Model>(load_urdf(path)));
    const VectorXd q = Eigen::Vector2d(0.9, -1.8);
    const Goal goal = pose_goal(find_frame(scene, "two/b"), Partial{0.3 * std::sin(-0.5), kOpen, kOpen});
    const PlacedScene out = place(scene, q, {goal});
    EXPECT_TRUE(out.met());
    return out.q[1];
  };
  EXPECT_EQ(placed(""), -1.8);
  EXPECT_EQ(placed("lower='-3' upper='3'"), -1.8);
  EXPECT_EQ(placed("lower='0' upper='0'"), 0);
  EXPECT_EQ(placed("lower='0.2' upper='0.2'"), 0.2);
}

// Poses that need more than a hundred steps are met. A search that ends before it does reports that.
TEST(Place, SearchesWhileTheErrorFalls) {
  const std::string path = MANYCONTACT_SHARED_DIR "/reports/third-motions/03-pose-needs-more-steps/scene.xml";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "skipped: no " << path;
  EXPECT_NO_THROW((void)load_scene(path));
  const SceneFile file = read_scene(path);
  std::vector<Goal> goals;
  for (const ScenePose& p : file.poses) goals.push_back(pose_goal(p.frame, {p.x, p.y, p.z}, {p.roll, p.pitch, p.yaw}));
  const PlacedScene found = place(file.scene, file.q, goals);
  EXPECT_TRUE(found.met());
  EXPECT_FALSE(found.out_of_steps);
  EXPECT_GT(found.iterations, 100);
  const PlacedScene ended = place(file.scene, file.q, goals, {.iterations = 100});
  EXPECT_FALSE(ended.met());
  EXPECT_TRUE(ended.out_of_steps);
  EXPECT_EQ(ended.iterations, 100);
}

// Goals that contradict each other end the search at a minimum, not for lack of steps.
TEST(Place, EndsWhereTheErrorStays) {
  const SceneFile file = two_robots();
  const Attachment tool = find_frame(file.scene, "a/tool");
  const PlacedScene found = place(
      file.scene, file.q, {pose_goal(tool, Partial{9, kOpen, kOpen}), pose_goal(tool, Partial{-9, kOpen, kOpen})});
  EXPECT_FALSE(found.met());
  EXPECT_FALSE(found.out_of_steps);
}

}  // namespace
}  // namespace manycontact::test
