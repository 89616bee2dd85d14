// Robots are read from URDF files: elements become joints, bodies, frames.

#include "manycontact/io/urdf.hpp"

#include <gtest/gtest.h>

#include <filesystem>

#include "manycontact/io/input_error.hpp"
#include "support/folder.hpp"

namespace manycontact {
namespace {

constexpr double kRounding = 1e-14;

Model load(const std::string& inside, const UrdfOptions& options = {}, std::vector<Finding>* findings = nullptr) {
  const test::TemporaryFolder folder;
  return load_urdf(folder.write("robot.urdf", "<robot name=\"test\">\n" + inside + "</robot>\n"), options, findings);
}

std::string link_of(const std::string& name, double mass = 1, const std::string& origin = "") {
  return "<link name=\"" + name + "\"><inertial>" + origin + "<mass value=\"" + std::to_string(mass) +
         "\"/><inertia ixx=\"0.1\" ixy=\"0.01\" ixz=\"0.02\" iyy=\"0.2\" iyz=\"0.03\" "
         "izz=\"0.15\"/></inertial></link>\n";
}

std::string joint_of(const std::string& name, const std::string& type, const std::string& parent,
                     const std::string& child, const std::string& inside = "") {
  const bool limited = inside.find("<limit") != std::string::npos;
  return "<joint name=\"" + name + "\" type=\"" + type + "\"><parent link=\"" + parent + "\"/><child link=\"" + child +
         "\"/>" + inside + (limited ? "" : "<limit effort=\"5\" velocity=\"6\" lower=\"-1\" upper=\"2\"/>") +
         "</joint>\n";
}

const std::string kTurned = "<origin xyz=\"0.1 0.2 0.3\" rpy=\"0.4 -0.5 0.6\"/>";

SE3<double> turned() {
  return {rotation_about<double>(Vec3<double>::UnitZ(), 0.6) * rotation_about<double>(Vec3<double>::UnitY(), -0.5) *
              rotation_about<double>(Vec3<double>::UnitX(), 0.4),
          Vec3<double>(0.1, 0.2, 0.3)};
}

void expect_same(const SE3<double>& a, const SE3<double>& b) {
  EXPECT_LT((a.R - b.R).cwiseAbs().maxCoeff(), kRounding);
  EXPECT_LT((a.p - b.p).cwiseAbs().maxCoeff(), kRounding);
}

void expect_same(const Inertia<double>& a, const Inertia<double>& b) {
  EXPECT_NEAR(a.m, b.m, kRounding);
  EXPECT_LT((a.h - b.h).cwiseAbs().maxCoeff(), kRounding);
  EXPECT_LT((a.I - b.I).cwiseAbs().maxCoeff(), kRounding);
}

const Frame& frame(const Model& model, const std::string& name) { return model.frames.at(model.find_frame(name)); }

UrdfOptions floating() {
  UrdfOptions o;
  o.floating_base = true;
  return o;
}

TEST(Urdf, NumbersJointsDepthFirstByName) {
  const Model m =
      load(link_of("base") + link_of("b") + link_of("a") + link_of("a1") + joint_of("j_b", "revolute", "base", "b") +
           joint_of("j_a", "continuous", "base", "a") + joint_of("j_c", "prismatic", "a", "a1"));
  ASSERT_EQ(m.njoints(), 3);
  EXPECT_EQ(m.joints[0].name, "j_a");
  EXPECT_EQ(m.joints[1].name, "j_c");
  EXPECT_EQ(m.joints[2].name, "j_b");
  EXPECT_EQ(m.joints[1].parent, 0);
  EXPECT_EQ(m.joints[2].parent, -1);
  EXPECT_EQ(m.joints[0].type, JointType::kRevolute);
  EXPECT_EQ(m.joints[1].type, JointType::kPrismatic);
  EXPECT_EQ(m.joints[0].axis, Vec3<double>::UnitX());  // URDF's default
  EXPECT_EQ(m.nv, 3);
  EXPECT_EQ(m.name, "test");
}

TEST(Urdf, ReadsLimits) {
  const Model m = load(link_of("a") + link_of("b") + link_of("c") + link_of("d") + joint_of("r", "revolute", "a", "b") +
                       joint_of("s", "continuous", "b", "c") + joint_of("t", "planar", "c", "d"));
  EXPECT_EQ(m.joints[0].lower[0], -1);
  EXPECT_EQ(m.joints[0].upper[0], 2);
  EXPECT_EQ(m.joints[0].effort_limit[0], 5);
  EXPECT_EQ(m.joints[0].velocity_limit[0], 6);
  EXPECT_TRUE(std::isinf(m.joints[1].lower[0]));
  EXPECT_EQ(m.joints[1].effort_limit[0], 5);
  EXPECT_TRUE(std::isinf(m.joints[2].upper[2]));
}

// A range of one position and zero effort are read; a joint without a range is free, a continuous joint never has one.
TEST(Urdf, LimitsOfRealFiles) {
  const auto limits = [](const char* type, const std::string& range) {
    return load(link_of("a") + link_of("b") +
                joint_of("j", type, "a", "b", "<limit effort=\"0\" velocity=\"0\" " + range + "/>"))
        .joints[0];
  };
  for (const char* type : {"revolute", "prismatic"})
    for (const char* range : {"lower=\"0\" upper=\"0\"", "lower=\"-0\" upper=\"0\""})
      EXPECT_EQ(limits(type, range).upper[0], 0) << type << " " << range;
  for (const char* type : {"revolute", "prismatic"}) EXPECT_TRUE(std::isinf(limits(type, "").upper[0])) << type;
  EXPECT_EQ(limits("revolute", "lower=\"0.5\" upper=\"0.5\"").lower[0], 0.5);
  EXPECT_TRUE(std::isinf(limits("continuous", "lower=\"1\" upper=\"-1\"").lower[0]));
}

TEST(Urdf, FloatingBaseCarriesTheRootLink) {
  const std::string robot = link_of("a", 2) + link_of("b", 3) + joint_of("j", "revolute", "a", "b");
  const Model fixed = load(robot), free = load(robot, floating());
  EXPECT_EQ(free.joints[0].name, "root");
  EXPECT_EQ(free.joints[0].type, JointType::kFloating);
  EXPECT_TRUE(free.floating_base);
  EXPECT_EQ(free.nv, 7);
  EXPECT_EQ(free.nq, 8);
  EXPECT_NEAR(free.mass(), 5, kRounding);
  EXPECT_NEAR(fixed.mass(), 3, kRounding);  // the root link cannot move
  EXPECT_EQ(fixed.nv, 1);
  EXPECT_EQ(frame(fixed, "a").joint, -1);
}

TEST(Urdf, FloatingBaseAvoidsTheNameOfAJoint) {
  const Model m = load(link_of("a") + link_of("b") + joint_of("root", "revolute", "a", "b"), floating());
  EXPECT_EQ(m.joints[0].name, "root_");
  EXPECT_EQ(m.joints[1].name, "root");
}

TEST(Urdf, MergesFixedJoints) {
  const std::string com = "<origin xyz=\"0.3 0.1 -0.2\" rpy=\"0.4 -0.5 0.6\"/>";
  const Model m = load(link_of("a") + link_of("b", 2) + link_of("c", 3, com) + link_of("d", 4) +
                       joint_of("j", "revolute", "a", "b") + joint_of("f", "fixed", "b", "c", kTurned) +
                       joint_of("k", "revolute", "c", "d", kTurned));
  ASSERT_EQ(m.njoints(), 2);
  EXPECT_EQ(m.notes.merged, std::vector<std::string>{"f"});
  expect_same(frame(m, "c").placement, turned());
  EXPECT_EQ(frame(m, "c").joint, 0);
  EXPECT_EQ(m.joints[1].parent, 0);
  expect_same(m.joints[1].placement, turned() * turned());
  Mat3<double> I;
  I << 0.1, 0.01, 0.02, 0.01, 0.2, 0.03, 0.02, 0.03, 0.15;
  Inertia<double> expected = Inertia<double>::from_com(2, Vec3<double>::Zero(), I);
  const Mat3<double> R = turned().R;
  expected += Inertia<double>::from_com(3, Vec3<double>(0.3, 0.1, -0.2), R * I * R.transpose()).transformed(turned());
  expect_same(m.joints[0].inertia, expected);
}

TEST(Urdf, LockedJointsLeaveTheModel) {
  const std::string robot = link_of("a") + link_of("b", 2) + link_of("c", 3) + link_of("d", 4) +
                            joint_of("j", "revolute", "a", "b", "<axis xyz=\"0 0 2\"/>" + kTurned) +
                            joint_of("k", "prismatic", "b", "c", "<axis xyz=\"0 1 0\"/>" + kTurned) +
                            joint_of("l", "revolute", "c", "d", "<axis xyz=\"0 1 1\"/>");
  UrdfOptions o = floating();
  const Model whole = load(robot, o);
  o.locked = {{"j", 0.7}, {"k", -0.3}};
  const Model m = load(robot, o);
  EXPECT_EQ(m.nv, whole.nv - 2);
  EXPECT_NEAR(m.mass(), whole.mass(), kRounding);
  EXPECT_EQ(m.notes.locked, (std::vector<std::string>{"j", "k"}));
  const SE3<double> b =
      turned() * SE3<double>{rotation_about<double>(Vec3<double>::UnitZ(), 0.7), Vec3<double>::Zero()};
  const SE3<double> c = b * turned() * SE3<double>{Mat3<double>::Identity(), Vec3<double>(0, -0.3, 0)};
  expect_same(frame(m, "b").placement, b);
  expect_same(frame(m, "c").placement, c);
  expect_same(m.joints[1].placement, c);
  EXPECT_NEAR(m.joints[1].axis.norm(), 1, kRounding);
}

TEST(Urdf, PlanarJointsTurnZToTheAxisAndKeepTheLinkFrame) {
  const Model flat =
      load(link_of("a") + link_of("b") + joint_of("j", "planar", "a", "b", "<axis xyz=\"0 0 1\"/>" + kTurned));
  const Inertia<double> inertia = flat.joints[0].inertia;
  expect_same(flat.joints[0].placement, turned());
  for (const char* axis : {"0 0 1", "0 0 -1", "1 0 0", "0 -3 0", "1 2 3", "1e-9 0 -1", "1 -1 -5", ""}) {
    SCOPED_TRACE(axis);
    const std::string given = *axis ? "<axis xyz=\"" + std::string(axis) + "\"/>" : "";
    const Model m =
        load(link_of("a") + link_of("b") + link_of("c") + joint_of("j", "planar", "a", "b", given + kTurned) +
             joint_of("k", "revolute", "b", "c", kTurned));
    const Joint& j = m.joints[0];
    EXPECT_EQ(j.type, JointType::kPlanar);
    EXPECT_EQ(m.nv, 4);
    const SE3<double> link = frame(m, "b").placement;
    expect_same(j.placement * link, turned());
    expect_same(j.inertia, inertia.transformed(link));
    expect_same(m.joints[1].placement, link * turned());
    Vec3<double> n(1, 0, 0);
    if (*axis) std::istringstream(axis) >> n[0] >> n[1] >> n[2];
    n.normalize();
    const Mat3<double> R = link.R.transpose();
    EXPECT_LT((R.col(2) - n).cwiseAbs().maxCoeff(), kRounding);
    EXPECT_LT((R.transpose() * R - Mat3<double>::Identity()).cwiseAbs().maxCoeff(), kRounding);
    EXPECT_NEAR(R.trace(), 1 + 2 * n.z(), kRounding);  // the smallest such rotation
  }
}

TEST(Urdf, ArmatureSparesTheFloatingBase) {
  UrdfOptions o = floating();
  o.armature = 0.5;
  o.joint_armature = {{"k", {0.25}}, {"p", {1, 2, 3}}};
  const Model m = load(link_of("a") + link_of("b") + link_of("c") + link_of("d") + joint_of("j", "revolute", "a", "b") +
                           joint_of("k", "revolute", "b", "c") + joint_of("p", "planar", "c", "d"),
                       o);
  Eigen::VectorXd expected(11);
  expected << 0, 0, 0, 0, 0, 0, 0.5, 0.25, 1, 2, 3;
  EXPECT_EQ(m.armature, expected);
}

TEST(Urdf, NotesWhatIsNotModelled) {
  const Model m =
      load(link_of("a") + link_of("b") + link_of("c") + joint_of("j", "revolute", "a", "b", "<mimic joint=\"k\"/>") +
           joint_of("k", "revolute", "b", "c", "<dynamics damping=\"1\"/>"));
  EXPECT_EQ(m.notes.mimic, std::vector<std::string>{"j"});
  EXPECT_EQ(m.notes.dynamics, std::vector<std::string>{"k"});
  EXPECT_EQ(m.nv, 2);
}

TEST(Urdf, OptionsMustFitTheRobot) {
  const std::string robot = link_of("a") + link_of("b") + link_of("c") + link_of("d") +
                            joint_of("f", "fixed", "a", "b") + joint_of("p", "planar", "b", "c") +
                            joint_of("r", "revolute", "c", "d");
  const auto lock = [&](const std::string& name) {
    UrdfOptions o;
    o.locked[name] = 0;
    (void)load(robot, o);
  };
  EXPECT_NO_THROW(lock("r"));
  EXPECT_THROW(lock("f"), UrdfOptionError);
  EXPECT_THROW(lock("p"), UrdfOptionError);
  EXPECT_THROW(lock("x"), UrdfOptionError);
  const auto armature = [&](const std::string& name, std::vector<double> values) {
    UrdfOptions o;
    o.joint_armature[name] = std::move(values);
    (void)load(robot, o);
  };
  EXPECT_NO_THROW(armature("p", {1}));
  EXPECT_THROW(armature("p", {1, 2}), UrdfOptionError);
  EXPECT_THROW(armature("r", {-1}), UrdfOptionError);
  EXPECT_THROW(armature("f", {1}), UrdfOptionError);
}

TEST(Urdf, InertiasAreJudgedPerBody) {
  const auto body = [](const std::string& inertial) {
    return load(link_of("a") + "<link name=\"b\"><inertial>" + inertial + "</inertial></link>" + link_of("c", 5) +
                joint_of("j", "revolute", "a", "b") + joint_of("f", "fixed", "b", "c"));
  };
  // point mass: the inertia about the centre of mass is zero up to rounding
  EXPECT_NO_THROW(
      load("<link name=\"a\"/><link name=\"b\"><inertial><origin xyz=\"0.3 0.1 0.7\"/><mass value=\"3\"/>"
           "<inertia ixx=\"0\" ixy=\"0\" ixz=\"0\" iyy=\"0\" iyz=\"0\" izz=\"0\"/></inertial></link>" +
           joint_of("j", "revolute", "a", "b")));
  // no inertia at all, and inertia without mass
  EXPECT_NO_THROW(load("<link name=\"a\"/><link name=\"b\"/>" + joint_of("j", "revolute", "a", "b")));
  EXPECT_NO_THROW(
      load("<link name=\"a\"/><link name=\"b\"><inertial><mass value=\"0\"/><inertia ixx=\"1\" ixy=\"0\" "
           "ixz=\"0\" iyy=\"0\" iyz=\"0\" izz=\"0\"/></inertial></link>" +
           joint_of("j", "revolute", "a", "b")));
  // negative, compensated by a merged link
  const char* inertia = "<inertia ixx=\"-0.01\" ixy=\"0\" ixz=\"0\" iyy=\"0\" iyz=\"0\" izz=\"0\"/>";
  EXPECT_NO_THROW(body("<mass value=\"-1\"/>" + std::string(inertia)));
  EXPECT_THROW(body("<mass value=\"-6\"/>" + std::string(inertia)), InputError);
}

// A principal moment above the sum of the other two is accepted with a warning, or refused on request: rods and plates
// reach the sum, and no body exceeds it.
TEST(Urdf, InertiasThatNoBodyHas) {
  const auto taken = [](const std::string& xx, const std::string& yy, const std::string& zz,
                        const std::string& mass = "2", const std::string& origin = "", const std::string& merged = "") {
    const std::string inertia =
        "<inertia ixx=\"" + xx + "\" ixy=\"0\" ixz=\"0\" iyy=\"" + yy + "\" iyz=\"0\" izz=\"" + zz + "\"/>";
    const std::string body = "<link name=\"a\"/>\n<link name=\"b\"><inertial>" + origin + "<mass value=\"" + mass +
                             "\"/>" + inertia + "</inertial></link>" + joint_of("j", "revolute", "a", "b") + merged;
    std::vector<Finding> findings;
    (void)load(body, {}, &findings);
    UrdfOptions strict;
    strict.refuse_inertia = true;
    if (findings.empty()) {
      EXPECT_NO_THROW((void)load(body, strict));
      return true;
    }
    const Finding& f = findings.at(0);
    EXPECT_EQ(f.kind + " " + f.name + " " + std::to_string(f.line), "inertia b 3");
    EXPECT_NE(f.text.find("violate the triangle inequality"), std::string::npos) << f.text;
    EXPECT_THROW((void)load(body, strict), InputError);
    return false;
  };
  const std::string far = "<origin xyz=\"3 -10 7\" rpy=\"0.4 -0.5 0.6\"/>";
  for (const std::string& origin : {std::string(), far}) {
    EXPECT_TRUE(taken("0.1", "0.2", "0.3", "2", origin));  // a plate, up to the rounding of these three
    EXPECT_TRUE(taken("0.3", "0.1", "0.2", "2", origin));
    EXPECT_TRUE(taken("0.7", "0", "0.7", "2", origin));  // a rod
    EXPECT_TRUE(taken("0", "0", "0", "2", origin));
    EXPECT_FALSE(taken("1", "1", "5", "2", origin));
    EXPECT_FALSE(taken("1", "0", "0", "2", origin));
    EXPECT_FALSE(taken("0.1", "0.2", "0.301", "2", origin));
  }
  EXPECT_TRUE(taken("1", "1", "2.000000001"));  // within 1e-9 of the trace, 4
  EXPECT_FALSE(taken("1", "1", "2.00000001"));
  EXPECT_TRUE(taken("1", "0", "0", "0"));  // without mass: a rotor
  EXPECT_TRUE(taken("0.1", "0.1", "0.25", "2", "", link_of("c", 3) + joint_of("f", "fixed", "b", "c")));  // compensated
}

TEST(Urdf, ToleratesWhatRealFilesHold) {
  testing::internal::CaptureStderr();
  testing::internal::CaptureStdout();
  const Model m = load(
      "<material name=\"m\"/><material name=\"m\"/><gazebo reference=\"a\"><joint/></gazebo>\n"
      "<link name=\"a\"><visual><geometry><box size=\"%s %n\"/></geometry><material "
      "name=\"%s%s%n\"/></visual></link>\n"
      "<link name=\"b\"><collision><geometry><blob/></geometry></collision></link>\n"
      "<joint name=\"j\" type=\"revolute\"><parent link=\"a\"/><child link=\"b\"/>"
      "<origin xyz=\"1\t2\n  +3 \" rpy=\" 0 0 0\"/><axis xyz=\"0 0\t1\"/><limit effort=\" 1\" "
      "velocity=\"1e-400\"/>"
      "<dynamics D=\"1\"/><safety_controller/><calibration rising=\"x\"/></joint>\n"
      "<link name=\"c\"/><joint name=\"f\" type=\"fixed\"><parent link=\"b\"/><child link=\"c\"/>"
      "<axis xyz=\"0 0 0\"/><limit/></joint>\n<transmission name=\"t\"><joint name=\"j\"/></transmission>\n");
  EXPECT_EQ(testing::internal::GetCapturedStderr() + testing::internal::GetCapturedStdout(), "");
  EXPECT_EQ(m.nv, 1);
  EXPECT_EQ(m.joints[0].placement.p, Vec3<double>(1, 2, 3));
  EXPECT_EQ(m.joints[0].axis, Vec3<double>::UnitZ());
}

// Deep recursion would overflow the stack, also when urdfdom's tree is freed.
TEST(Urdf, LongChain) {
  constexpr int kLinks = 5000;
  std::string robot;
  const auto name = [](int i) { return "l" + std::to_string(100000 - i); };
  for (int i = 0; i < kLinks; ++i) robot += "<link name=\"" + name(i) + "\"/>\n";
  for (int i = 1; i < kLinks; ++i) robot += joint_of("j" + name(i), "continuous", name(i - 1), name(i));
  const Model m = load(robot);
  EXPECT_EQ(m.nv, kLinks - 1);
  EXPECT_EQ(m.dof_depth[m.nv - 1], kLinks - 2);
}

TEST(Urdf, SharedRobots) {
  const std::string folder = std::string(MANYCONTACT_SHARED_DIR) + "/robots/";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << folder << " is not here";
  const std::pair<const char*, int> robots[] = {{"anymal.urdf", 12},
                                                {"panda.urdf", 9},
                                                {"simple_humanoid.urdf", 29},
                                                {"solo12.urdf", 12},
                                                {"talos_reduced.urdf", 32}};
  for (const auto& [file, nv] : robots) {
    SCOPED_TRACE(file);
    testing::internal::CaptureStderr();
    const Model fixed = load_urdf(folder + file), free = load_urdf(folder + file, floating());
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
    EXPECT_EQ(fixed.nv, nv);
    EXPECT_EQ(free.nv, nv + 6);
    EXPECT_EQ(free.nu(), nv);
    EXPECT_EQ(fixed.frames.size(), free.frames.size());
    EXPECT_GE(free.mass(), fixed.mass());
  }
}

}  // namespace
}  // namespace manycontact
