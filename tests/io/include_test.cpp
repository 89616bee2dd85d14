// Scenes include scenes; joints are passive; damping and friction come from the URDF.

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "manycontact/io/scene_file.hpp"
#include "manycontact/io/urdf.hpp"
#include "support/folder.hpp"

namespace manycontact {
namespace {

namespace fs = std::filesystem;

const std::string kIncluded = R"(<robot name="r"><link name="a"/>
  <link name="b"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <link name="c"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="hip" type="continuous"><parent link="a"/><child link="b"/><dynamics damping="0.5" friction="2"/></joint>
  <joint name="knee" type="continuous"><parent link="b"/><child link="c"/></joint></robot>)";

class Include : public testing::Test {
 protected:
  Include() {
    for (const std::string place : {"", "sub/", "sub/deeper/"}) (void)folder_.write(place + "robot.urdf", kIncluded);
  }

  void write(const std::string& name, const std::string& inside, const std::string& attributes = "") const {
    (void)folder_.write(name, "<scene" + attributes + ">\n" + inside + "\n</scene>\n");
  }
  SceneFile read(const std::string& name = "scene.xml") const { return read_scene((folder_ / name).string()); }
  std::string problem(const std::string& name = "scene.xml") const {
    try {
      (void)read(name);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }
  void expect_problem(const std::string& place, const std::string& text) const {
    const std::string said = problem();
    EXPECT_EQ(said.find('\n'), std::string::npos);
    EXPECT_NE(said.find(place), std::string::npos) << said;
    EXPECT_NE(said.find(text), std::string::npos) << said;
  }

  test::TemporaryFolder folder_;
};

std::string robot(const std::string& name) { return "<robot name=\"" + name + "\" urdf=\"robot.urdf\"/>\n"; }
std::string include(const std::string& file) { return "<include file=\"" + file + "\"/>\n"; }

// Included elements replace the <include>, their paths are relative to their file, and contacts connect files.
TEST_F(Include, RobotsAndContactsStandWhereTheyAreIncluded) {
  write("scene.xml", robot("first") + include("sub/one.xml") + robot("last") +
                         "<contact name=\"c\" type=\"3d\" frame=\"first/b\" to=\"two/c\"/>");
  write("sub/one.xml", robot("one") + include("deeper/two.xml") + "<contact name=\"d\" type=\"1d\" frame=\"last/c\"/>",
        " name=\"one\" gravity=\"0 0 -9.81\"");
  write("sub/deeper/two.xml", robot("two"));
  const SceneFile file = read();
  std::vector<std::string> names;
  for (const Robot& r : file.scene.robots) names.push_back(r.name);
  EXPECT_EQ(names, (std::vector<std::string>{"first", "one", "two", "last"}));
  EXPECT_EQ(file.scene.name, "scene");
  ASSERT_EQ(file.scene.contacts.size(), 2u);
  EXPECT_EQ(file.scene.contacts[0].name, "d");
  EXPECT_EQ(file.scene.contacts[0].A.robot, 3);
  EXPECT_EQ(file.scene.contacts[1].B.robot, 2);
  EXPECT_EQ(fs::path(file.robot_groups[2].urdf).lexically_normal(), (folder_ / "sub/deeper/robot.urdf"));
}

TEST_F(Include, MistakesNameFileAndLine) {
  write("scene.xml", robot("first") + include("none.xml"));
  expect_problem("scene.xml:3: ", "the scene file '" + (folder_ / "none.xml").string() + "'");
  write("scene.xml", include("sub"));
  expect_problem("scene.xml:2: ", "is a directory");
  write("scene.xml", "<include/>");
  expect_problem("scene.xml:2: ", "<include> has no attribute 'file'");
  write("scene.xml", "<include file=\"\"/>");
  expect_problem("scene.xml:2: ", "is empty");
  write("scene.xml", "<include file=\"a.xml\" prefix=\"b\"/>");
  expect_problem("scene.xml:2: ", "unknown attribute 'prefix'");
  write("scene.xml", include("one.xml"));
  write("one.xml", "\n<robt/>");
  expect_problem("one.xml:3: ", "<robt>");
  write("one.xml", robot("a") + robot("a"));
  expect_problem("one.xml:3: ", "exists already on line 2, ");
  write("scene.xml", robot("a") + include("one.xml"));
  write("one.xml", robot("a"));
  expect_problem("one.xml:2: ", "exists already on line 2 of " + (folder_ / "scene.xml").string());
  write("one.xml", robot("b"), " gravity=\"0 0 -1.62\"");
  expect_problem("one.xml:1: ", "gravity differs from the gravity of the including scene");
  write("one.xml", robot("b"), " damping=\"1e-6\"");
  expect_problem("one.xml:1: ", "damping differs from the value in the including scene");
  write("one.xml", robot("b"), " tolerance=\"1e-6\"");
  expect_problem("one.xml:1: ", "tolerance differs from the value in the including scene");
  write("one.xml", robot("b"), " consistent=\"true\"");
  expect_problem("one.xml:1: ", "consistent=\"true\" is missing in the including scene");
  write("one.xml", robot("b"), " consistent=\"yes\"");
  expect_problem("one.xml:1: ", "consistent");
  write("one.xml", robot("b"), " consistent=\"false\"");
  EXPECT_EQ(problem(), "");
}

TEST_F(Include, CirclesAndDepthAreRefused) {
  write("scene.xml", include("scene.xml"));
  expect_problem("scene.xml:2: ", "includes itself");
  write("scene.xml", include("sub/one.xml"));
  write("sub/one.xml", "\n" + include("../sub/../scene.xml"));
  expect_problem("one.xml:3: ", "includes itself");
  for (int k = 0; k < 40; ++k) write("d" + std::to_string(k) + ".xml", include("d" + std::to_string(k + 1) + ".xml"));
  write("d40.xml", robot("r"));
  write("scene.xml", include("d0.xml"));
  expect_problem("d15.xml:2: ", "more than 16 levels deep");
  write("scene.xml", include("d30.xml"));
  EXPECT_EQ(read().scene.nrobots(), 1);
  // one file from two places is not a cycle; files with robots are refused by their names, others by their number
  std::string twice = include("e1.xml") + include("e1.xml");
  for (int k = 1; k < 12; ++k) {
    const std::string next = include("e" + std::to_string(k + 1) + ".xml");
    write("e" + std::to_string(k) + ".xml", next + next);
  }
  write("e12.xml", "");
  write("scene.xml", twice);
  expect_problem(".xml:", "more than 1000 scene files are included");
}

TEST_F(Include, PassiveJointsHaveNoTorque) {
  write("scene.xml", R"(<robot name="r" urdf="robot.urdf" base="floating"><joint name="hip" actuated="false"/>
    <joint name="knee" u="3"/></robot> <robot name="s" urdf="robot.urdf"><u>1 2</u></robot>)");
  const SceneFile file = read();
  EXPECT_EQ(file.scene.nu, 3);
  EXPECT_EQ(torque_names(file.scene), (std::vector<std::string>{"r/knee", "s/hip", "s/knee"}));
  EXPECT_EQ(file.u, Eigen::Vector3d(3, 1, 2));
  EXPECT_EQ(u_index(file.scene, "r", "knee"), 0);
  EXPECT_EQ(u_index(file.scene, "s", "knee"), 2);
  EXPECT_THROW((void)u_index(file.scene, "r", "hip"), std::invalid_argument);
  EXPECT_NE(file.scene.robots[0].model, file.scene.robots[1].model);
  const auto refused = [&](const std::string& joint, const std::string& text) {
    write("scene.xml", "<robot name=\"r\" urdf=\"robot.urdf\" base=\"floating\">" + joint + "</robot>");
    expect_problem("scene.xml:2: ", text);
  };
  refused("<joint name=\"hip\" actuated=\"false\" u=\"1\"/>",
          "joint 'hip' is passive, expected u of an actuated joint");
  refused("<joint name=\"hip\" actuated=\"no\"/>", "actuated of <joint> is 'no'");
  refused("<joint name=\"root\" actuated=\"false\"/>", "is the floating base, which has no torques");
  refused("<joint name=\"knee\" actuated=\"false\"/><lock joint=\"knee\" at=\"0\"/>", "joint 'knee' is locked");
  refused("<joint name=\"hp\" actuated=\"false\"/>", "the robot has no joint 'hp', expected one of 'hip', 'knee'");
}

TEST_F(Include, DynamicsOfTheUrdf) {
  write("scene.xml",
        "<robot name=\"r\" urdf=\"robot.urdf\" dynamics=\"model\"/><robot name=\"s\" urdf=\"robot.urdf\"/>");
  const SceneFile file = read();
  const Model &with = *file.scene.robots[0].model, &without = *file.scene.robots[1].model;
  EXPECT_EQ(with.damping, Eigen::Vector2d(0.5, 0));
  EXPECT_EQ(with.friction, Eigen::Vector2d(2, 0));
  EXPECT_TRUE(with.notes.dynamics.empty());
  EXPECT_EQ(without.damping.size(), 0);
  EXPECT_EQ(without.notes.dynamics, std::vector<std::string>{"hip"});
  ASSERT_EQ(file.findings.size(), 1u);
  EXPECT_EQ(file.findings[0].kind + " " + file.findings[0].name, "dynamics s/hip");
  std::string bad = kIncluded;
  bad.replace(bad.find("0.5"), 3, "inf");
  std::ofstream(folder_ / "robot.urdf") << bad;
  expect_problem("robot.urdf:4: ", "joint 'hip' has the damping or friction inf, expected a finite number");
  bad.replace(bad.find("inf"), 3, "-1.");  // it drives the joint, and a warning is printed
  std::ofstream(folder_ / "robot.urdf") << bad;
  const SceneFile driven = read();
  EXPECT_EQ(driven.scene.robots[0].model->damping[0], -1);
  EXPECT_EQ(driven.findings.size(), 2u);
}

}  // namespace
}  // namespace manycontact
