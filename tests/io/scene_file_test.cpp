// Scenes are read from their files: robots, copies, state, contacts.

#include "manycontact/io/scene_file.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <numbers>
#include <sstream>

#include "manycontact/algorithm/configuration.hpp"
#include "manycontact/detail/contact/reference.hpp"
#include "manycontact/io/urdf.hpp"
#include "support/folder.hpp"

namespace manycontact {
namespace {

namespace fs = std::filesystem;

constexpr double kTight = 1e-14;

std::string link(const std::string& name, double mass) {
  return "<link name=\"" + name + "\"><inertial><mass value=\"" + std::to_string(mass) +
         "\"/><inertia ixx=\"0.1\" ixy=\"0\" ixz=\"0\" iyy=\"0.1\" iyz=\"0\" "
         "izz=\"0.1\"/></inertial></link>\n";
}

// trunk - hip - leg - (fixed ankle) - foot, and trunk - arm - hand; joints by name: hip, shoulder
const std::string kRobot =
    "<robot name=\"r\">\n" + link("trunk", 5) + link("leg", 2) + link("foot", 1) + link("hand", 3) +
    "<joint name=\"hip\" type=\"continuous\"><origin xyz=\"0 0 -0.2\"/><parent link=\"trunk\"/><child "
    "link=\"leg\"/>"
    "<axis xyz=\"0 1 0\"/></joint>\n"
    "<joint name=\"ankle\" type=\"fixed\"><origin xyz=\"0 0 -0.5\" rpy=\"0.1 0.2 0.3\"/><parent "
    "link=\"leg\"/>"
    "<child link=\"foot\"/></joint>\n"
    "<joint name=\"shoulder\" type=\"continuous\"><origin xyz=\"0.3 0 0.4\"/><parent link=\"trunk\"/>"
    "<child link=\"hand\"/><axis xyz=\"1 0 0\"/></joint>\n</robot>\n";

const std::string kSlider = "<robot name=\"s\">\n<link name=\"base\"/>\n" + link("load", 7) +
                            "<joint name=\"lift\" type=\"prismatic\"><parent link=\"base\"/><child "
                            "link=\"load\"/><axis xyz=\"0 0 1\"/>"
                            "<limit effort=\"1\" velocity=\"1\"/></joint>\n</robot>\n";

class SceneFileTest : public testing::Test {
 protected:
  SceneFileTest() {
    (void)folder_.write("robot.urdf", kRobot);
    (void)folder_.write("sub/slider.urdf", kSlider);
  }

  SceneFile load(const std::string& inside, const std::string& attributes = "") const {
    return read_scene(folder_.write("scene.xml", "<scene" + attributes + ">\n" + inside + "</scene>\n"));
  }

  test::TemporaryFolder folder_;
};

Eigen::VectorXd vector(std::initializer_list<double> values) {
  return Eigen::Map<const Eigen::VectorXd>(values.begin(), static_cast<Eigen::Index>(values.size()));
}

void expect_near(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  ASSERT_EQ(a.size(), b.size());
  EXPECT_LT((a - b).cwiseAbs().maxCoeff(), kTight) << a.transpose() << "\n" << b.transpose();
}

void expect_near(const SE3<double>& a, const SE3<double>& b) {
  EXPECT_LT((a.R - b.R).cwiseAbs().maxCoeff(), kTight) << a.R << "\n" << b.R;
  EXPECT_LT((a.p - b.p).cwiseAbs().maxCoeff(), kTight) << a.p.transpose() << "\n" << b.p.transpose();
}

SE3<double> yaw(double angle, double x = 0, double y = 0, double z = 0) {
  return {rotation_about<double>(Vec3<double>::UnitZ(), angle), Vec3<double>(x, y, z)};
}

// Returns the pose from the seven numbers of a floating base.
SE3<double> pose(const Eigen::VectorXd& q, int at) {
  return {rotation_of_quaternion(q[at + 3], q[at + 4], q[at + 5], q[at + 6]), Vec3<double>(q.segment<3>(at))};
}

const Contact& contact(const SceneFile& s, const std::string& name) {
  return s.scene.contacts.at(s.scene.contact_index.at(name));
}

TEST_F(SceneFileTest, SceneAttributes) {
  const SceneFile s = load("", " name=\"x\" gravity=\"0 1 -2\" damping=\"1e-3\"");
  EXPECT_EQ(s.scene.name, "x");
  EXPECT_EQ(s.scene.gravity, Vec3<double>(0, 1, -2));
  EXPECT_EQ(s.scene.damping, 1e-3);
  EXPECT_EQ(load("", " tolerance=\"1e-5\"").scene.tolerance, 1e-5);
  EXPECT_EQ(load("", " moment_length=\"0.1\"").scene.moment_length, 0.1);
  EXPECT_EQ(load("").scene.moment_length, 1);
  const SceneFile plain = load("");
  EXPECT_EQ(plain.scene.name, "scene");  // the file's name
  EXPECT_EQ(plain.scene.gravity, Vec3<double>(0, 0, -9.81));
  EXPECT_EQ(plain.scene.nrobots(), 0);
}

TEST_F(SceneFileTest, BasePlacement) {
  const SceneFile s = load(R"(<robot name="a" urdf="robot.urdf" base="floating" xyz="1 2 3" rpy="0 0 0.5"/>
    <robot name="b" urdf="sub/slider.urdf" base="fixed" xyz="1 2 3" rpy="0 0 0.5"/>
    <robot name="c" urdf="sub/slider.urdf"/>)");
  expect_near(pose(s.q, 0), yaw(0.5, 1, 2, 3));
  expect_near(s.scene.robots[1].base, yaw(0.5, 1, 2, 3));
  EXPECT_FALSE(s.scene.robots[2].model->floating_base);
  EXPECT_EQ(s.scene.nq, 9 + 1 + 1);
  EXPECT_EQ(s.scene.nu, 2 + 1 + 1);
}

// Robot::base is where a floating base starts, in whichever way the file gives it.
TEST_F(SceneFileTest, FloatingBasesStartWhereTheyStand) {
  const SceneFile s = load(R"(<robot name="a" urdf="robot.urdf" base="floating" xyz="1 2 3" rpy="0.1 0.2 3"/>
    <robot name="b" urdf="robot.urdf" base="floating" copies="4" arrange="circle" spacing="2" xyz="0 0 1" rpy="0 1 2"/>
    <robot name="c" urdf="robot.urdf" base="floating" copies="2"><q>1 0 3 0.6 0 0 -0.8 0.4 0.5</q></robot>
    <robot name="d" urdf="robot.urdf" base="floating"><joint name="root" q="1 2 3 0 0 1 0"/></robot>)");
  const Eigen::VectorXd start = neutral(s.scene);
  for (const Robot& r : s.scene.robots) {
    SCOPED_TRACE(r.name);
    expect_near(r.base, pose(s.q, r.idx_q));
    expect_near(pose(start, r.idx_q), pose(s.q, r.idx_q));
    EXPECT_EQ(start.segment<2>(r.idx_q + 7), Eigen::Vector2d::Zero());
  }
  EXPECT_EQ(s.q[s.scene.robots[6].idx_q + 6], -0.8);  // as written
}

TEST_F(SceneFileTest, RpyTurnsAboutFixedAxes) {
  const SceneFile s = load(R"(<robot name="b" urdf="sub/slider.urdf" base="fixed" rpy="0.1 0.2 0.3"/>)");
  const Mat3<double> R = rotation_about<double>(Vec3<double>::UnitZ(), 0.3) *
                         rotation_about<double>(Vec3<double>::UnitY(), 0.2) *
                         rotation_about<double>(Vec3<double>::UnitX(), 0.1);
  expect_near(s.scene.robots[0].base, {R, Vec3<double>::Zero()});
}

TEST_F(SceneFileTest, WholeVectorsAndNormalisedQuaternion) {
  const SceneFile s = load(R"(<robot name="a" urdf="robot.urdf" base="floating">
    <q>1 2 3  0 0 0.6000001 0.8000001 <!-- hip --> 0.25
       +0.5</q><v>1 2 3 4 5 6 7 8</v><u>-1 1e1</u></robot>)");
  expect_near(s.q, vector({1, 2, 3, 0, 0, 0.6000001 / std::hypot(0.6000001, 0.8000001),
                           0.8000001 / std::hypot(0.6000001, 0.8000001), 0.25, 0.5}));
  EXPECT_NEAR(s.q.segment<4>(3).norm(), 1, kTight);
  EXPECT_EQ(s.v, vector({1, 2, 3, 4, 5, 6, 7, 8}));
  EXPECT_EQ(s.u, vector({-1, 10}));
}

TEST_F(SceneFileTest, JointValues) {
  const SceneFile s = load(R"(<robot name="a" urdf="robot.urdf" base="floating" armature="0.5" xyz="0 0 1">
    <joint name="shoulder" q="0.4" v="0.2" u="7" armature="0.25"/><joint name="root" v="1 2 3 4 5 6"/></robot>
    <robot name="b" urdf="robot.urdf" base="floating"><joint name="root" q="1 2 3 0 0 1 0"/></robot>)");
  EXPECT_EQ(s.q, vector({0, 0, 1, 0, 0, 0, 1, 0, 0.4, 1, 2, 3, 0, 0, 1, 0, 0, 0}));
  EXPECT_EQ(s.v, vector({1, 2, 3, 4, 5, 6, 0, 0.2, 0, 0, 0, 0, 0, 0, 0, 0}));
  EXPECT_EQ(s.u, vector({0, 7, 0, 0}));
  EXPECT_EQ(s.scene.robots[0].model->armature, vector({0, 0, 0, 0, 0, 0, 0.5, 0.25}));
}

TEST_F(SceneFileTest, Locks) {
  const SceneFile s = load(R"(<robot name="a" urdf="robot.urdf" base="floating"/>
    <robot name="b" urdf="robot.urdf" base="floating"><lock joint="shoulder" at="0.1"/><u>3</u></robot>)");
  const Model &a = *s.scene.robots[0].model, &b = *s.scene.robots[1].model;
  EXPECT_EQ(b.nv, a.nv - 1);
  EXPECT_NEAR(b.mass(), a.mass(), kTight);
  EXPECT_EQ(b.notes.locked, std::vector<std::string>{"shoulder"});
  expect_near(b.frames[b.find_frame("hand")].placement,
              {rotation_about<double>(Vec3<double>::UnitX(), 0.1), Vec3<double>(0.3, 0, 0.4)});
}

TEST_F(SceneFileTest, EqualRobotsShareOneModel) {
  const SceneFile s = load(R"(<robot name="a" urdf="robot.urdf" base="floating"/>
    <robot name="b" urdf="sub/../robot.urdf" base="floating" xyz="1 0 0"/>
    <robot name="c" urdf="robot.urdf"/> <robot name="d" urdf="robot.urdf" base="floating" armature="1"/>
    <robot name="e" urdf="robot.urdf" base="floating" copies="3"/>)");
  const auto model = [&](int i) { return s.scene.robots[i].model; };
  EXPECT_EQ(model(0), model(1));
  EXPECT_NE(model(0), model(2));
  EXPECT_NE(model(0), model(3));
  EXPECT_EQ(model(0), model(4));
  EXPECT_EQ(model(4), model(6));
  EXPECT_EQ(s.robot_group, (std::vector<int>{0, 1, 2, 3, 4, 4, 4}));
  EXPECT_EQ(s.robot_groups[4].count, 3);
  EXPECT_EQ(s.robot_groups[4].first, 4);
  EXPECT_TRUE(s.robot_groups[4].copied);
  EXPECT_EQ(s.scene.robots[6].name, "e2");
  EXPECT_EQ(s.robot_groups[0].urdf, (folder_ / "robot.urdf").string());
}

TEST_F(SceneFileTest, ArrangedInLineAndGrid) {
  const SceneFile s = load(R"(<robot name="a" urdf="robot.urdf" base="floating" copies="3" xyz="0 0 1"/>
    <robot name="b" urdf="sub/slider.urdf" copies="3" arrange="line" spacing="2" xyz="0 5 0"/>
    <robot name="c" urdf="sub/slider.urdf" copies="5" arrange="grid" spacing="2"/>)");
  for (int i = 0; i < 3; ++i) EXPECT_EQ(s.q.segment<3>(9 * i), vector({1.0 * i, 0, 1}));
  EXPECT_EQ(s.scene.robots[5].base.p, Vec3<double>(4, 5, 0));
  EXPECT_EQ(s.scene.robots[6].base.p, Vec3<double>(0, 0, 0));  // three columns
  EXPECT_EQ(s.scene.robots[8].base.p, Vec3<double>(4, 0, 0));
  EXPECT_EQ(s.scene.robots[10].base.p, Vec3<double>(2, 2, 0));
}

TEST_F(SceneFileTest, ArrangedInACircle) {
  const SceneFile s = load(R"(<robot name="a" urdf="robot.urdf" base="floating" copies="6" arrange="circle" spacing="2"
      xyz="0.1 0.2 0.3" rpy="0 0 0.7"/>
    <robot name="b" urdf="sub/slider.urdf" copies="2" arrange="circle" spacing="2"/>
    <robot name="c" urdf="sub/slider.urdf" copies="1" arrange="circle" spacing="2"/>)");
  for (int i = 0; i < 6; ++i) {
    const double angle = std::numbers::pi / 3 * i;  // six neighbours a radius apart
    const SE3<double> arranged = yaw(angle, 2 * std::cos(angle), 2 * std::sin(angle));
    expect_near(pose(s.q, 9 * i), arranged * yaw(0.7, 0.1, 0.2, 0.3));
  }
  expect_near(s.scene.robots[7].base, yaw(std::numbers::pi, -1));
  expect_near(s.scene.robots[8].base, yaw(0));
}

TEST_F(SceneFileTest, CopiesShareQBesideTheArrangement) {
  const SceneFile s = load(R"(<robot name="a" urdf="robot.urdf" base="floating" copies="4" arrange="circle" spacing="2">
    <q>1 0 3 0.6 0 0 0.8 0.4 0.5</q><joint name="hip" v="2"/><u>3 4</u></robot>)");
  const SE3<double> own = {rotation_of_quaternion(0.6, 0., 0., 0.8), Vec3<double>(1, 0, 3)};
  for (int i = 0; i < 4; ++i) {
    const double angle = std::numbers::pi / 2 * i, r = std::sqrt(2);
    expect_near(pose(s.q, 9 * i), yaw(angle, r * std::cos(angle), r * std::sin(angle)) * own);
    EXPECT_EQ(s.q[9 * i + 8], 0.5);
    EXPECT_EQ(s.v[8 * i + 6], 2);
    EXPECT_EQ(s.u[2 * i + 1], 4);
  }
}

// These torques need a solver, so reading leaves them open and lists their robots.
TEST_F(SceneFileTest, GravityTorquesAreLeftOpen) {
  const SceneFile s = load(R"(<robot name="a" urdf="sub/slider.urdf"/>
    <robot name="b" urdf="sub/slider.urdf" copies="2" u="gravity"/>
    <robot name="c" urdf="sub/slider.urdf"><u>1</u></robot>)");
  EXPECT_EQ(s.gravity_robots, (std::vector<int>{1, 2}));
  EXPECT_EQ(s.u[0], 0);
  EXPECT_TRUE(std::isnan(s.u[1]) && std::isnan(s.u[2]));
  EXPECT_EQ(s.u[3], 1);
  EXPECT_TRUE(load(R"(<robot name="a" urdf="sub/slider.urdf"/>)").gravity_robots.empty());
}

TEST_F(SceneFileTest, ContactAttributes) {
  const SceneFile s = load(R"(<robot name="a" urdf="robot.urdf" base="floating" xyz="0 0 1"/>
    <contact name="c1" type="1d" frame="a/foot" reference_frame="world" axis="0 3 4" gains="25 10"
             active="false" offset="0.1 0 0" offset_quat_xyzw="0 0 0.6 0.8" xyz="1 2 3" quat_xyzw="0 0 1 0"/>
    <contact name="c2" type="2d" frame="a/foot" reference_frame="local_world_aligned"/>
    <contact name="c3" type="3d" frame="a/hand" reference_frame="local"/>
    <contact name="c6" type="6d" frame="a/trunk"/>)");
  const Contact& c = contact(s, "c1");
  EXPECT_EQ(c.type, ContactType::k1D);
  EXPECT_EQ(c.reference_frame, ReferenceFrame::kWorld);
  EXPECT_FALSE(c.active);
  EXPECT_EQ(c.alpha, 25);
  EXPECT_EQ(c.beta, 10);
  EXPECT_LT((c.axis - Vec3<double>(0, 0.6, 0.8)).norm(), kTight);
  const Model& m = *s.scene.robots[0].model;
  EXPECT_EQ(c.A.robot, 0);
  EXPECT_EQ(c.A.joint, m.find_joint("hip"));
  expect_near(c.A.placement, m.frames[m.find_frame("foot")].placement *
                                 SE3<double>{rotation_of_quaternion(0., 0., 0.6, 0.8), Vec3<double>(0.1, 0, 0)});
  EXPECT_EQ(c.B.robot, -1);
  expect_near(c.B.placement, yaw(std::numbers::pi, 1, 2, 3));
  EXPECT_EQ(contact(s, "c2").type, ContactType::k2D);
  EXPECT_EQ(contact(s, "c2").reference_frame, ReferenceFrame::kLocalWorldAligned);
  EXPECT_EQ(contact(s, "c3").type, ContactType::k3D);
  EXPECT_EQ(contact(s, "c6").type, ContactType::k6D);
  EXPECT_TRUE(contact(s, "c6").active);
  expect_near(contact(s, "c6").B.placement, yaw(0, 0, 0, 1));  // where the trunk is
}

// Each omitted part is placed where A is; the given part stays.
TEST_F(SceneFileTest, ReferencesLeftOutAreResolved) {
  const std::string robots = R"(<robot name="a" urdf="robot.urdf" base="floating" xyz="0 0 1" rpy="0.3 0 0">
      <joint name="hip" q="0.4"/></robot>
    <robot name="b" urdf="robot.urdf" base="floating" xyz="2 0 1" rpy="0 0.5 0"/>)";
  for (const bool world : {true, false})
    for (const bool position : {true, false})
      for (const bool orientation : {true, false}) {
        std::string attributes = world ? "" : " to=\"b/foot\"";
        if (position) attributes += std::string(world ? " xyz" : " to_offset") + "=\"0.1 0.2 0.3\"";
        if (orientation) attributes += std::string(world ? " quat_xyzw" : " to_offset_quat_xyzw") + "=\"0 0.6 0 0.8\"";
        SCOPED_TRACE(attributes);
        const SceneFile s = load(robots + "<contact name=\"c\" type=\"6d\" frame=\"a/hand\"" + attributes + "/>");
        const Contact& c = contact(s, "c");
        Contact resolved = c;
        resolve_reference(s.scene, s.q, true, true, resolved);
        SE3<double> on_link{rotation_of_quaternion(0., 0.6, 0., 0.8), Vec3<double>(0.1, 0.2, 0.3)};
        if (!world) on_link = s.scene.robots[1].model->frames[2].placement * on_link;
        const SE3<double> expected{orientation ? on_link.R : resolved.B.placement.R,
                                   position ? on_link.p : resolved.B.placement.p};
        if (!world) {
          EXPECT_EQ(s.scene.robots[1].model->frames[2].name, "foot");
        }
        expect_near(c.B.placement, expected);
        EXPECT_EQ(c.B.robot, world ? -1 : 1);
      }
}

// A scene is the same whether it is read or built.
TEST_F(SceneFileTest, BuiltInCodeIsTheSame) {
  const std::string file_contacts[] = {
      R"(type="6d" frame="a/foot" offset="0.1 0 0")",
      R"(type="1d" frame="a/foot" axis="0 3 4" reference_frame="world" gains="25 10")",
      R"(type="1d" frame="a/foot" axis="0 3e-9 4e-9")",
      R"(type="3d" frame="a/hand" to="t/load")",
      R"(type="3d" frame="a/hand" to="t/base")",
      R"(type="2d" frame="t/base" to="a/trunk")",
      R"(type="3d" frame="a/trunk" to="a/hand")",
  };
  std::string text = R"(<robot name="a" urdf="robot.urdf" base="floating" xyz="0 0 1" rpy="0.3 0 0.2"/>
    <robot name="t" urdf="sub/slider.urdf" xyz="1 2 3" rpy="0 0 0.5"/>)";
  int n = 0;
  for (const std::string& c : file_contacts) text += "<contact name=\"c" + std::to_string(n++) + "\" " + c + "/>\n";
  const SceneFile file = load(text);

  Scene scene;
  const SE3<double> base{
      rotation_about<double>(Vec3<double>::UnitZ(), 0.2) * rotation_about<double>(Vec3<double>::UnitX(), 0.3),
      Vec3<double>(0, 0, 1)};
  UrdfOptions floating;
  floating.floating_base = true;
  add_robot(scene, "a", std::make_shared<Model>(load_urdf((folder_ / "robot.urdf").string(), floating)), base);
  add_robot(scene, "t", std::make_shared<Model>(load_urdf((folder_ / "sub" / "slider.urdf").string())),
            yaw(0.5, 1, 2, 3));
  expect_near(neutral(scene), file.q);
  const auto add = [&](ContactType type, const Attachment& A, const Attachment& B, Contact c = {}) {
    c.name = "c" + std::to_string(scene.contacts.size());
    c.type = type, c.A = A, c.B = B;
    resolve_reference(scene, neutral(scene), true, true, c);
    add_contact(scene, c);
  };
  const Attachment world, foot = attach(scene, "a", "foot"), hand = attach(scene, "a", "hand"),
                          trunk = attach(scene, "a", "trunk");
  add(ContactType::k6D, attach(scene, "a", "foot", yaw(0, 0.1)), world);
  Contact along;
  along.axis = Vec3<double>(0, 3, 4);
  along.reference_frame = ReferenceFrame::kWorld;
  along.alpha = 25, along.beta = 10;
  add(ContactType::k1D, foot, world, along);
  Contact short_axis;
  short_axis.axis = Vec3<double>(0, 3e-9, 4e-9);
  add(ContactType::k1D, foot, world, short_axis);
  add(ContactType::k3D, hand, attach(scene, "t", "load"));
  add(ContactType::k3D, hand, attach(scene, "t", "base"));
  add(ContactType::k2D, attach(scene, "t", "base"), trunk);
  add(ContactType::k3D, trunk, hand);

  ASSERT_EQ(scene.contacts.size(), file.scene.contacts.size());
  for (std::size_t k = 0; k < scene.contacts.size(); ++k) {
    SCOPED_TRACE(k);
    const Contact &built = scene.contacts[k], &read = file.scene.contacts[k];
    EXPECT_EQ(built.name, read.name);
    EXPECT_EQ(built.type, read.type);
    EXPECT_EQ(built.reference_frame, read.reference_frame);
    EXPECT_EQ(built.axis, read.axis);
    EXPECT_EQ(built.alpha, read.alpha);
    EXPECT_EQ(built.beta, read.beta);
    for (const auto& [b, r] : {std::pair{&built.A, &read.A}, std::pair{&built.B, &read.B}}) {
      EXPECT_EQ(b->robot, r->robot);
      EXPECT_EQ(b->joint, r->joint);
      EXPECT_EQ(b->frame, r->frame);
      expect_near(b->placement, r->placement);
    }
  }
}

TEST_F(SceneFileTest, AnImmovableLinkIsTheWorld) {
  const SceneFile s = load(R"(<robot name="a" urdf="robot.urdf" base="floating"/>
    <robot name="t" urdf="sub/slider.urdf" xyz="1 2 3" rpy="0 0 0.5"/>
    <contact name="c" type="6d" frame="a/foot" to="t/base" to_offset="0.1 0 0" to_offset_quat_xyzw="0 0 0 1"/>
    <contact name="d" type="6d" frame="t/base" to="a/hand"/>)");
  EXPECT_EQ(contact(s, "c").B.robot, -1);
  expect_near(contact(s, "c").B.placement, yaw(0.5, 1, 2, 3) * yaw(0, 0.1));
  EXPECT_EQ(contact(s, "c").A.frame, "foot");
  EXPECT_EQ(contact(s, "c").B.frame, "t/base");
  EXPECT_EQ(contact(s, "d").A.robot, 1);
  EXPECT_EQ(contact(s, "d").A.joint, -1);
}

TEST_F(SceneFileTest, ContactsAreCopiedWithTheirRobot) {
  const SceneFile s = load(R"(<contact name="foot" type="3d" frame="herd/foot"/>
    <robot name="herd" urdf="robot.urdf" base="floating" copies="3" spacing="2"/>
    <robot name="table" urdf="sub/slider.urdf" xyz="0 0 1"/>
    <contact name="one" type="3d" frame="herd1/hand"/>
    <contact name="hold" type="3d" frame="herd/hand" to="table/load"/>
    <contact name="loop" type="3d" frame="herd/hand" to="herd/foot"/>)");
  ASSERT_EQ(s.scene.contacts.size(), 3u + 1 + 3 + 3);
  for (int i = 0; i < 3; ++i) {
    const std::string n = std::to_string(i);
    EXPECT_EQ(contact(s, "foot" + n).A.robot, i);
    EXPECT_EQ(contact(s, "foot" + n).B.placement.p.x(), 2.0 * i);
    EXPECT_EQ(contact(s, "hold" + n).B.robot, 3);
    EXPECT_EQ(contact(s, "loop" + n).A.robot, i);
    EXPECT_EQ(contact(s, "loop" + n).B.robot, i);
  }
  EXPECT_EQ(contact(s, "one").A.robot, 1);
  EXPECT_EQ(s.contact_groups.size(), 4u);
  EXPECT_EQ(s.contact_groups[0].count, 3);
  EXPECT_FALSE(s.contact_groups[1].copied);
}

struct Ties {
  const char* to;
  std::vector<std::string> expected;  // "contact: robot A > robot B"
};

TEST_F(SceneFileTest, ContactsToOtherCopies) {
  const std::vector<Ties> cases = {
      {"to=\"herd+1/foot\"", {"c0: 0 > 1", "c1: 1 > 2"}},
      {"to=\"herd+1/foot\" wrap=\"false\"", {"c0: 0 > 1", "c1: 1 > 2"}},
      {"to=\"herd+1/foot\" wrap=\"true\"", {"c0: 0 > 1", "c1: 1 > 2", "c2: 2 > 0"}},
      {"to=\"herd-1/foot\"", {"c1: 1 > 0", "c2: 2 > 1"}},
      {"to=\"herd-1/foot\" wrap=\"true\"", {"c0: 0 > 2", "c1: 1 > 0", "c2: 2 > 1"}},
      {"to=\"herd+2/foot\"", {"c0: 0 > 2"}},
      {"to=\"herd+5/foot\"", {}},
      {"to=\"herd+5/foot\" wrap=\"true\"", {"c0: 0 > 2", "c1: 1 > 0", "c2: 2 > 1"}},
      {"to=\"herd+0/foot\"", {"c0: 0 > 0", "c1: 1 > 1", "c2: 2 > 2"}},
      {"to=\"flock/foot\"", {"c0: 0 > 3", "c1: 1 > 4", "c2: 2 > 5"}},
      {"to=\"flock+1/foot\"", {"c0: 0 > 4", "c1: 1 > 5"}},
      {"to=\"flock0/foot\"", {"c0: 0 > 3", "c1: 1 > 3", "c2: 2 > 3"}},
      {"to=\"go-1/foot\"", {"c0: 0 > 6", "c1: 1 > 6", "c2: 2 > 6"}},
  };
  for (const Ties& c : cases) {
    SCOPED_TRACE(c.to);
    const SceneFile s = load(R"(<robot name="herd" urdf="robot.urdf" base="floating" copies="3"/>
      <robot name="flock" urdf="robot.urdf" base="floating" copies="3"/>
      <robot name="go-1" urdf="robot.urdf" base="floating"/>
      <contact name="c" type="3d" frame="herd/hand" )" +
                             std::string(c.to) + "/>");
    std::vector<std::string> found;
    for (const Contact& k : s.scene.contacts)
      found.push_back(k.name + ": " + std::to_string(k.A.robot) + " > " + std::to_string(k.B.robot));
    EXPECT_EQ(found, c.expected);
    EXPECT_EQ(s.contact_groups[0].count, static_cast<int>(c.expected.size()));
  }
}

TEST_F(SceneFileTest, CopiesAreAnyWholeNumber) {
  for (const auto& [text, count] : {std::pair{"1e2", 100}, {"1e5", 100000}, {"100000", 100000}, {"2.5e1", 25}}) {
    const SceneFile s = load("<robot name=\"a\" urdf=\"sub/slider.urdf\" copies=\"" + std::string(text) + "\"/>");
    EXPECT_EQ(s.scene.nrobots(), count);
    EXPECT_EQ(s.robot_groups[0].count, count);
  }
}

TEST_F(SceneFileTest, ManyCopiesTakeLinearTime) {
  const SceneFile s = load(R"(<robot name="herd" urdf="robot.urdf" base="floating" copies="50000" arrange="circle"/>
    <contact name="foot" type="3d" frame="herd/foot"/>
    <contact name="hold" type="6d" frame="herd/hand" to="herd+1/trunk" wrap="true"/>)");
  EXPECT_EQ(s.scene.nrobots(), 50000);
  EXPECT_EQ(s.scene.contacts.size(), 100000u);
  EXPECT_EQ(s.scene.nq, 450000);
}

// The order of coordinates is that of Pinocchio's figures.
TEST(SceneFile, SharedScenes) {
  const fs::path folder = fs::path(MANYCONTACT_SHARED_DIR) / "golden";
  if (!fs::exists(folder)) GTEST_SKIP() << folder << " is not here";
  int scenes = 0;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (entry.path().extension() != ".xml") continue;
    SCOPED_TRACE(entry.path().filename());
    ++scenes;
    const SceneFile s = read_scene(entry.path().string());
    std::ifstream in(fs::path(entry.path()).replace_extension(".json"));
    std::stringstream json;
    json << in.rdbuf();
    std::string names = "\"velocity_names\":[";
    for (const std::string& n : velocity_names(s.scene)) names += (names.back() == '[' ? "\"" : ",\"") + n + "\"";
    EXPECT_NE(json.str().find(names + "]"), std::string::npos) << names;
  }
  EXPECT_GT(scenes, 0);
}

TEST_F(SceneFileTest, ExternalWrenches) {
  const SceneFile file = load(R"(
    <robot name="one" urdf="robot.urdf" base="floating"/>
    <robot name="many" urdf="robot.urdf" base="floating" copies="3" arrange="circle" spacing="2"/>
    <push frame="one/foot" offset="0.1 0 0" force="1 2 3" torque="4 5 6"/>
    <push name="wind" frame="many/hand" force="0 7 0" reference_frame="world"/>
    <push frame="many2/leg"/>)");
  const Scene& scene = file.scene;
  ASSERT_EQ(scene.wrenches.size(), 5u);
  const ExternalWrench& first = scene.wrenches[0];
  EXPECT_EQ(first.name, "one/foot");
  EXPECT_EQ(first.wrench, (Vec6<double>() << 1, 2, 3, 4, 5, 6).finished());
  EXPECT_EQ(first.reference_frame, ReferenceFrame::kLocal);
  const SE3<double> offset{Mat3<double>::Identity(), {0.1, 0, 0}};
  const Attachment foot = attach(scene, "one", "foot", offset);
  EXPECT_EQ(first.at.joint, foot.joint);
  expect_near(first.at.placement, foot.placement);
  for (int k = 0; k < 3; ++k) {  // the world's axes apply to every copy
    const ExternalWrench& wind = scene.wrenches[static_cast<std::size_t>(1 + k)];
    EXPECT_EQ(wind.name, "wind" + std::to_string(k));
    EXPECT_EQ(wind.at.robot, 1 + k);
    EXPECT_EQ(wind.wrench[1], 7);
    EXPECT_EQ(wind.reference_frame, ReferenceFrame::kWorld);
  }
  EXPECT_EQ(scene.wrenches[4].name, "many2/leg");
  EXPECT_EQ(scene.wrench_index.at("wind2"), 3);
}

TEST_F(SceneFileTest, Springs) {
  const SceneFile file = load(R"(
    <robot name="one" urdf="robot.urdf" base="floating" xyz="0 0 1"/>
    <robot name="many" urdf="robot.urdf" copies="3" spacing="2">
      <joint name="hip" stiffness="20" rest="0.5" damping="0.25"/>
    </robot>
    <spring frame="one/hand" to="one/leg" stiffness="100"/>
    <spring name="rope" frame="one/trunk" offset="0 0 1" xyz="0 3 2" stiffness="5" damping="2"/>
    <spring name="row" frame="many/leg" to="many+1/leg" stiffness="9" length="0.5"/>
    <spring name="base" frame="many0/trunk" to="one/trunk" stiffness="9"/>)");
  const Scene& scene = file.scene;
  ASSERT_EQ(scene.springs.size(), 5u);
  EXPECT_EQ(scene.springs[0].name, "one/hand to one/leg");
  EXPECT_NEAR(scene.springs[0].length, Vec3<double>(0.3, 0, 0.6).norm(), 1e-14);
  EXPECT_NEAR(scene.springs[1].length, 3, 1e-14);  // from (0, 0, 2)
  EXPECT_EQ(scene.springs[1].damping, 2);
  EXPECT_EQ(scene.springs[2].name, "row0");
  EXPECT_EQ(scene.springs[3].B.robot, 3);
  EXPECT_EQ(scene.springs[3].length, 0.5);
  EXPECT_EQ(scene.springs[4].A.robot, 0);  // bodies fixed to the ground are the world
  EXPECT_EQ(scene.springs[4].B.robot, -1);
  EXPECT_NEAR(scene.springs[4].length, 1, 1e-14);
  ASSERT_EQ(scene.joint_springs.size(), 3u);
  EXPECT_EQ(scene.joint_springs[2].robot, 3);
  EXPECT_EQ(scene.joint_springs[2].stiffness, 20);
  EXPECT_EQ(scene.joint_springs[2].rest, 0.5);
  const Model& model = *scene.robots[1].model;
  EXPECT_EQ(model.damping[model.joints[static_cast<std::size_t>(model.find_joint("hip"))].idx_v], 0.25);
  EXPECT_EQ(scene.robots[0].model->damping.size(), 0);
  EXPECT_EQ(file.open_lengths, (std::vector<int>{0, 1, 4}));
}

}  // namespace
}  // namespace manycontact
