// The search of place() leaves saddles, finds minima under limits in few steps, works far from the origin and from
// several starts, and finds balanced configurations.

#include <gtest/gtest.h>

#include <cmath>

#include "manycontact/algorithm/configuration.hpp"
#include "manycontact/algorithm/rigid_body.hpp"
#include "manycontact/analysis/consistent.hpp"
#include "manycontact/analysis/findings.hpp"
#include "manycontact/analysis/load_scene.hpp"
#include "manycontact/analysis/place.hpp"
#include "support/folder.hpp"
#include "support/random.hpp"
#include "support/scenes.hpp"

namespace manycontact::test {
namespace {

using Eigen::VectorXd;

constexpr double kSearched = 1e-9;
constexpr auto kAnywhere = std::nullopt;

// A planar arm along x has links of these lengths; every joint but the first has the limits.
std::string arm_urdf(const std::vector<double>& lengths, double lower, double upper) {
  std::string out = "<robot name='arm'><link name='l0'/>";
  double before = 0;
  for (std::size_t i = 0; i < lengths.size(); ++i) {
    const std::string n = std::to_string(i + 1);
    out +=
        "<link name='l" + n + "'><inertial><origin xyz='" + std::to_string(lengths[i] / 2) +
        " 0 0'/><mass value='1'/><inertia ixx='0.01' ixy='0' ixz='0' iyy='0.01' iyz='0' izz='0.01'/></inertial></link>"
        "<joint name='j" +
        n + "' type='" + (i == 0 ? "continuous" : "revolute") + "'><parent link='l" + std::to_string(i) +
        "'/><child link='l" + n + "'/><origin xyz='" + std::to_string(before) + " 0 0'/><axis xyz='0 0 1'/>" +
        (i == 0 ? std::string()
                : "<limit lower='" + std::to_string(lower) + "' upper='" + std::to_string(upper) +
                      "' effort='9' velocity='9'/>") +
        "</joint>";
    before = lengths[i];
  }
  return out + "<link name='tip'/><joint name='t' type='fixed'><parent link='l" + std::to_string(lengths.size()) +
         "'/><child link='tip'/><origin xyz='" + std::to_string(before) + " 0 0'/></joint></robot>";
}

struct Arm {
  TemporaryFolder folder;
  SceneFile file;
  Arm(const std::vector<double>& lengths, double lower, double upper, const std::string& inside = "",
      const std::string& attributes = "") {
    folder.write("arm.urdf", arm_urdf(lengths, lower, upper));
    file = load_scene_text(
        "<scene gravity='0 0 0' " + attributes + "><robot name='r' urdf='arm.urdf'/>" + inside + "</scene>",
        (folder / "scene.xml").string());
  }
};

// ---- saddles -------------------------------------------------------------------------------------------------------

// Stretched, with the target along the arm, J^T e is zero. Two links have cos e = (x^2 - a^2 - b^2) / 2 a b. An elbow
// whose range begins at its straight configuration bends the one way that remains.
TEST(PlaceSearch, BendsWhatIsStretched) {
  const double bent = std::acos((0.36 - 0.25 - 0.16) / 0.4);
  const Arm either({0.5, 0.4}, -2.8, 2.8, "<pose frame='r/tip' x='0.6' y='0'/>");
  EXPECT_NEAR(std::abs(either.file.q[1]), bent, 1e-8);
  const Arm left({0.5, 0.4}, 0, 2.8, "<pose frame='r/tip' x='0.6' y='0'/>");
  EXPECT_NEAR(left.file.q[1], bent, 1e-8);
  const Arm right({0.5, 0.4}, -2.8, 0, "<pose frame='r/tip' x='0.6' y='0'/>");
  EXPECT_NEAR(right.file.q[1], -bent, 1e-8);
  for (const double x : {0.05, 0.5, -0.3, 1.19, -1.1})
    for (const auto& lengths : std::vector<std::vector<double>>{{0.5, 0.4, 0.3}, {0.3, 0.3, 0.3, 0.3}}) {
      const Arm arm(lengths, -2.8, 2.8);
      const PlacedScene found = place(arm.file.scene, arm.file.q,
                                      {pose_goal(find_frame(arm.file.scene, "r/tip"), Partial{x, 0.0, kAnywhere})},
                                      {.restarts = 20});  // a target behind leads some searches to limits first
      EXPECT_TRUE(found.met(kSearched)) << x << " " << lengths.size();
    }
}

TEST(PlaceSearch, BendsWhatIsStretchedToCloseContacts) {
  const Arm arm({0.5, 0.4}, -2.8, 2.8,
                "<contact name='c' type='3d' frame='r/tip' reference_frame='world' xyz='0.6 0 0'/>",
                "consistent='true'");
  EXPECT_NEAR(std::abs(arm.file.q[1]), std::acos((0.36 - 0.25 - 0.16) / 0.4), 1e-8);
}

// From straight knees the soles stay where they are and the pelvis goes lower. Robots without goals stay as they are.
TEST(PlaceSearch, CrouchesFromStraightKnees) {
  for (const double down : {0.01, 0.12, 0.3}) {
    const SceneFile file = load_text(
        "<scene><robot name='h' urdf=\"humanoid.urdf\" base='floating' xyz='0 0 0.85'/>"
        "<robot name='a' urdf=\"arm.urdf\" xyz='3 0 0'/>"
        "<pose frame='h/left_sole' xyz='0.04 0.09 0' rpy='0 0 0'/><pose frame='h/right_sole' xyz='0.04 -0.09 0' "
        "rpy='0 0 0'/><pose frame='h/pelvis' xyz='0 0 " +
        std::to_string(0.85 - down) + "' rpy='0 0 0'/></scene>");
    RigidBodyData data(file.scene);
    forward_kinematics(file.scene, file.q, data);
    EXPECT_NEAR(frame_placement(file.scene, data, find_frame(file.scene, "h/pelvis")).p[2], 0.85 - down, kSearched);
    for (const char* knee : {"left_knee", "right_knee"}) EXPECT_GT(file.q[q_index(file.scene, "h", knee)], 0.05);
    EXPECT_TRUE(file.q.tail(7).isZero(0));
  }
}

// ---- minima --------------------------------------------------------------------------------------------------------

// Hands have goals beyond their reach: to minima under limits Gauss-Newton's steps alone took thousands.
TEST(PlaceSearch, FindsMinimaInTensOfSteps) {
  const SceneFile file = load_text("<scene><robot name='h' urdf=\"humanoid.urdf\" base='floating'/></scene>");
  const Scene& scene = file.scene;
  for (unsigned seed = 1; seed <= 20; ++seed) {
    std::mt19937 rng(seed);
    const VectorXd start = random_configuration(scene, rng);
    std::vector<Goal> goals;
    for (const char* frame : {"h/left_hand", "h/right_hand", "h/left_sole", "h/right_sole"}) {
      const VectorXd x = random_vector(3, rng, 1.5);
      goals.push_back(pose_goal(find_frame(scene, frame), SE3<double>{Mat3<double>::Identity(), x.head<3>()}));
    }
    const PlacedScene found = place(scene, start, goals);
    EXPECT_LE(found.iterations, 90) << seed;
    const auto size = [&](const VectorXd& q) {
      double sum = 0;
      for (const GoalLeft& left : place(scene, q, goals, {.iterations = 0}).left)
        sum += left.position * left.position + left.angle * left.angle;
      return sum;
    };
    const double least = size(found.q);
    for (int k = 0; k < 100; ++k)
      EXPECT_GT(size(integrate(scene, found.q, random_vector(scene.nv, rng, 1e-3))), least * (1 - 1e-8)) << seed;
  }
}

// ---- tolerance, limits, restarts -----------------------------------------------------------------------------------

// Far away only the rounding error of places remains.
TEST(PlaceSearch, MeetsGoalsFarAway) {
  const SceneFile file = load_text("<scene><robot name='b' urdf=\"box.urdf\" base='floating'/></scene>");
  for (const double far : {1e3, 1e5, 1e7}) {
    VectorXd q = neutral(file.scene);
    q[0] = far;
    const PlacedScene found =
        place(file.scene, q, {pose_goal(find_frame(file.scene, "b/crate"), Partial{far + 1e-6, 1e-9, kAnywhere})});
    EXPECT_LE(found.left[0].position, 4e-16 * 4 * far + 1e-12) << far;
    EXPECT_LE(found.iterations, 20) << far;
  }
}

TEST(PlaceSearch, EqualLimitsLock) {
  const Arm arm({0.5, 0.4, 0.3}, 0.4, 0.4);
  const Scene& scene = arm.file.scene;
  const PlacedScene found =
      place(scene, arm.file.q, {pose_goal(find_frame(scene, "r/tip"), Partial{0.2, 0.2, kAnywhere})});
  EXPECT_EQ(found.q[1], 0.4);
  EXPECT_EQ(found.q[2], 0.4);
  RigidBodyData data(scene);
  forward_kinematics(scene, found.q, data);
  const Vec3<double> p = frame_placement(scene, data, find_frame(scene, "r/tip")).p;
  EXPECT_NEAR(p[0], p[1], 1e-8);  // it points to the goal
}

// An elbow bends one way only, and the target is on the other side of a limit of the shoulder. One search ends at a
// minimum short of it, one from another start reaches it. The same seed finds the same configuration.
TEST(PlaceSearch, StartsAgainWhenAsked) {
  const SceneFile file = load_text("<scene><robot name='a' urdf=\"arm.urdf\"/></scene>");
  const Scene& scene = file.scene;
  int alone = 0, again = 0;
  for (unsigned seed = 1; seed <= 20; ++seed) {
    std::mt19937 rng(seed);
    const VectorXd wanted = random_configuration(scene, rng);
    RigidBodyData data(scene);
    forward_kinematics(scene, wanted, data);
    const Attachment tool = find_frame(scene, "a/tool");
    const std::vector<Goal> goals = {pose_goal(tool, frame_placement(scene, data, tool))};
    const VectorXd start = random_configuration(scene, rng);
    alone += place(scene, start, goals).met(kSearched);
    const PlaceOptions options{.restarts = 50, .seed = 7};
    const PlacedScene found = place(scene, start, goals, options);
    again += found.met(kSearched);
    EXPECT_EQ(found.q, place(scene, start, goals, options).q);
  }
  EXPECT_LT(alone, 20);
  EXPECT_EQ(again, 20);
  EXPECT_THROW((void)place(scene, neutral(scene), {}, {.restarts = -1}), std::invalid_argument);
}

// ---- balanced configurations ---------------------------------------------------------------------------------------

SceneFile crouching(const std::string& poses) {
  return load_text("<scene name='crouching'><robot name='h' urdf=\"humanoid.urdf\" base='floating' u='gravity'/>" +
                   poses +
                   "<contact name='left' type='6d' frame='h/left_sole' mu='0.7' box='0.2 0.1'/>"
                   "<contact name='right' type='6d' frame='h/right_sole' mu='0.7' box='0.2 0.1'/></scene>");
}

std::string hints(const SceneFile& file) {
  std::string out;
  for (const Finding& f : file.findings)
    if (f.text.find("outside of the robot's contacts") != std::string::npos) out += f.text;
  return out;
}

Vec3<double> center(const SceneFile& file) {
  RigidBodyData data(file.scene);
  forward_kinematics(file.scene, file.q, data);
  return center_of_mass(RigidBodies(file.scene), data);
}

Vec3<double> middle_of_soles(const SceneFile& file) {
  RigidBodyData data(file.scene);
  forward_kinematics(file.scene, file.q, data);
  return 0.5 * (frame_placement(file.scene, data, find_frame(file.scene, "h/left_sole")).p +
                frame_placement(file.scene, data, find_frame(file.scene, "h/right_sole")).p);
}

// The pages' scene, and a symmetrical edition, are balanced, since the poses leave them free to be.
TEST(PoseStands, WherePosesAllowIt) {
  for (const std::string pelvis : {"z='0.65'", "z='0.5'", "z='0.8'", "z='0.65' pitch='0.1' roll='0'"})
    for (const std::string left : {"xyz='0 0.1 0' rpy='0 0 0'", "z='0' roll='0' pitch='0'"}) {
      const SceneFile file =
          crouching("<pose frame='h/left_sole' " + left + "/>" +
                    "<pose frame='h/right_sole' z='0' roll='0' pitch='0'/><pose frame='h/pelvis' " + pelvis + "/>");
      const Vec3<double> off = center(file) - middle_of_soles(file);
      EXPECT_LE(off.head<2>().norm(), 0.16) << pelvis << " " << left;
      EXPECT_EQ(hints(file), "") << pelvis << " " << left;
    }
}

TEST(PoseStands, OrIsToldWhereTheyDoNot) {
  const SceneFile file = crouching(
      "<pose frame='h/left_sole' xyz='0 0.1 0' rpy='0 0 0'/><pose frame='h/right_sole' xyz='0 -0.1 0' rpy='0 0 0'/>"
      "<pose com='h' x='0.3' z='0.6'/>");
  EXPECT_NEAR(center(file)[0], 0.3, kSearched);
  EXPECT_NEAR(center(file)[2], 0.6, kSearched);
  EXPECT_NE(hints(file).find("the centre of mass is 0."), std::string::npos) << hints(file);
}

// The first search of an arm that must rotate by half a turn ends at limits.
TEST(PoseRestarts, AreAsked) {
  const std::string pose = "<pose frame='r/tip' x='-1.1' y='0'/>";
  EXPECT_THROW(Arm({0.3, 0.3, 0.3, 0.3}, -2.8, 2.8, pose), InputError);
  const Arm arm({0.3, 0.3, 0.3, 0.3}, -2.8, 2.8, pose, "restarts='20'");
  RigidBodyData data(arm.file.scene);
  forward_kinematics(arm.file.scene, arm.file.q, data);
  EXPECT_NEAR(frame_placement(arm.file.scene, data, find_frame(arm.file.scene, "r/tip")).p[0], -1.1, kSearched);
  EXPECT_THROW(Arm({0.3}, 0, 0, "", "restarts='-1'"), InputError);
}

TEST(Poses, OfTheCentreOfMassAreChecked) {
  const auto refused = [](const std::string& pose) -> std::string {
    try {
      (void)crouching(pose);
    } catch (const InputError& e) {
      return e.message;
    }
    return "";
  };
  EXPECT_NE(refused("<pose com='h' yaw='1'/>").find("expected only x, y, z of the centre of mass"), std::string::npos);
  EXPECT_NE(refused("<pose com='k' x='1'/>").find("there is no robot 'k'"), std::string::npos);
  EXPECT_NE(refused("<pose com='h'/>").find("gives no coordinate"), std::string::npos);
  EXPECT_NE(refused("<pose com='h' z='9'/><pose frame='h/left_sole' xyz='0 0 0'/>").find("is missed by"),
            std::string::npos);
}

}  // namespace
}  // namespace manycontact::test
