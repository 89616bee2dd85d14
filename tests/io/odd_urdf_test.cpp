// URDFs are questionable but usable, as public ones are: they load, with a warning and its line.

#include <gtest/gtest.h>

#include <cmath>

#include "manycontact/io/scene_file.hpp"
#include "manycontact/io/urdf.hpp"
#include "support/folder.hpp"

namespace manycontact {
namespace {

class OddUrdf : public testing::Test {
 protected:
  // Line 2: `head`; line 3: link a; line 4: link b with `inertial`; line 5: joint j of a `type` with `inside` and the
  // attributes `more`; line 6: `tail`.
  std::string robot(const std::string& type, const std::string& inside, const std::string& inertial = kInertial,
                    const std::string& head = "", const std::string& tail = "") const {
    return folder_.write("robot.urdf", "<robot name=\"r\">\n" + head + "\n<link name=\"a\"/>\n<link name=\"b\">" +
                                           inertial + "</link>\n<joint name=\"j\" type=\"" + type +
                                           "\"><parent link=\"a\"/><child link=\"b\"/>" + inside + "</joint>\n" + tail +
                                           "</robot>\n");
  }
  struct Read {
    Model model;
    std::vector<Finding> findings;
  };
  static Read load(const std::string& path, const UrdfOptions& options = {}) {
    std::vector<Finding> findings;
    Model model = load_urdf(path, options, &findings);
    return {std::move(model), std::move(findings)};
  }
  Read model(const std::string& type, const std::string& inside, const std::string& inertial = kInertial,
             const std::string& head = "", const std::string& tail = "") const {
    return load(robot(type, inside, inertial, head, tail));
  }
  // Returns "kind name:line", one finding per line; and all texts.
  static std::string told(const Read& m) {
    std::string out;
    for (const Finding& f : m.findings)
      out += (out.empty() ? "" : "\n") + f.kind + " " + f.name + ":" + std::to_string(f.line);
    return out;
  }
  static std::string text(const Read& m) {
    std::string out;
    for (const Finding& f : m.findings) out += f.text + "\n";
    return out;
  }
  std::string refusal(const std::string& path, const UrdfOptions& options = {}) const {
    try {
      (void)load_urdf(path, options);
      return "accepted";
    } catch (const InputError& error) {
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
      return std::to_string(error.line) + ": " + error.message;
    }
  }

  static inline const std::string kInertial =
      "<inertial><mass value=\"2\"/><inertia ixx=\"1\" ixy=\"0\" ixz=\"0\" iyy=\"1\" iyz=\"0\" izz=\"1\"/></inertial>";
  test::TemporaryFolder folder_;
};

TEST_F(OddUrdf, LimitsThatBoundNothing) {
  struct Case {
    const char *type, *limit;
    double lower, upper, velocity, effort;
    const char* text;  // empty: no warning
  };
  constexpr double inf = std::numeric_limits<double>::infinity();
  const Case cases[] = {
      {"revolute", R"(<limit lower="-1" upper="2" velocity="3" effort="4"/>)", -1, 2, 3, 4, ""},
      {"revolute", "", -inf, inf, inf, inf, "the joint has no <limit> and is taken as unlimited"},
      {"prismatic", "", -inf, inf, inf, inf, "the joint has no <limit> and is taken as unlimited"},
      {"continuous", "", -inf, inf, inf, inf, ""},
      {"revolute", R"(<limit lower="-Inf" upper="Inf" velocity="3" effort="4"/>)", -inf, inf, 3, 4,
       "lower -Inf, upper Inf"},
      {"prismatic", R"(<limit lower="-infinity" upper="1e999" velocity="3" effort="4"/>)", -inf, inf, 3, 4,
       "upper 1e999"},
      {"revolute", R"(<limit lower="-1" upper="+INF" velocity="inf" effort="1e400"/>)", -1, inf, inf, inf,
       "velocity inf"},
      {"revolute", R"(<limit lower="inf" upper="-inf" velocity="3" effort="4"/>)", -inf, inf, 3, 4, "lower inf"},
      {"revolute", R"(<limit lower="2" upper="1" velocity="3" effort="4"/>)", -inf, inf, 3, 4, "lower 2 above upper 1"},
      {"revolute", R"(<limit lower="2" velocity="3" effort="4"/>)", -inf, inf, 3, 4, "lower 2 above upper 0"},
      {"revolute", R"(<limit upper="2" velocity="3" effort="4"/>)", 0, 2, 3, 4,
       "<limit> lacks lower, which is 0 by URDF's default"},
      {"revolute", R"(<limit velocity="3" effort="4"/>)", -inf, inf, 3, 4,
       "<limit> has no lower, no upper, where the joint is taken as unlimited"},
      {"continuous", R"(<limit effort="4"/>)", -inf, inf, inf, 4,
       "<limit> has no velocity, where the joint is taken as unlimited"},
      {"continuous", R"(<limit velocity="4"/>)", -inf, inf, 4, inf,
       "<limit> has no effort, where the joint is taken as unlimited"},
      {"continuous", "<limit/>", -inf, inf, inf, inf, "<limit> has no effort, no velocity, where"},
      {"continuous", R"(<limit lower="-Inf" upper="nan" velocity="5" effort="4"/>)", -inf, inf, 5, 4, ""},
      {"prismatic", R"(<limit lower="-1" upper="1" velocity="-1" effort="-0.5"/>)", -1, 1, inf, inf,
       "effort -0.5, velocity -1"},
      {"revolute", "<limit lower=\" -1\n\" upper=\"&#10;2\t\" velocity=\"0\" effort=\"1e-400\"/>", -1, 2, 0, 0, ""},
  };
  for (const Case& c : cases) {
    SCOPED_TRACE(std::string(c.type) + " " + c.limit);
    const Read m = model(c.type, c.limit);
    const Joint& j = m.model.joints.at(0);
    EXPECT_EQ(j.lower[0], c.lower);
    EXPECT_EQ(j.upper[0], c.upper);
    EXPECT_EQ(j.velocity_limit[0], c.velocity);
    EXPECT_EQ(j.effort_limit[0], c.effort);
    EXPECT_EQ(told(m), *c.text ? "limits j:5" : "");
    EXPECT_NE(text(m).find(c.text), std::string::npos) << text(m);
  }
}

TEST_F(OddUrdf, InertiasHalfThere) {
  const Read mass = model("continuous", "", "<inertial><mass value=\"3\"/></inertial>");
  EXPECT_EQ(mass.model.joints[0].inertia.m, 3);
  EXPECT_TRUE(mass.model.joints[0].inertia.I.isZero(0));
  EXPECT_EQ(told(mass) + ": " + text(mass), "inertia b:4: <inertial> lacks inertia; missing values are taken as 0\n");
  const Read diagonal =
      model("continuous", "", "<inertial><mass value=\"\n3 \"/><inertia ixx=\"1\" iyy=\"2\" izz=\"2\"/></inertial>");
  EXPECT_EQ(diagonal.model.joints[0].inertia.I, Mat3<double>(Vec3<double>(1, 2, 2).asDiagonal()));
  EXPECT_EQ(text(diagonal), "<inertial> lacks ixy, ixz, iyz; missing values are taken as 0\n");
  const Read rotor = model("continuous", "", "<inertial><inertia ixx=\"1\" iyy=\"0\" izz=\"0\"/></inertial>");
  EXPECT_EQ(rotor.model.joints[0].inertia.m, 0);
  EXPECT_EQ(rotor.model.joints[0].inertia.I(0, 0), 1);
  EXPECT_EQ(told(model("continuous", "", "<inertial/>")), "inertia b:4");
  EXPECT_EQ(told(model("continuous", "<axis/>")), "unread j:5");
  EXPECT_EQ(model("continuous", "<axis/>").model.joints[0].axis, Vec3<double>::UnitX());
}

TEST_F(OddUrdf, ANegativeMassMadeGood) {
  const std::string negative =
      "<link name=\"c\"><inertial><mass value=\"-0.5\"/><inertia ixx=\"0\" ixy=\"0\" ixz=\"0\" iyy=\"0\" iyz=\"0\" "
      "izz=\"0\"/></inertial></link><joint name=\"f\" type=\"fixed\"><parent link=\"b\"/><child link=\"c\"/></joint>";
  const Read m = model("continuous", "", kInertial, "", negative);
  EXPECT_EQ(m.model.joints[0].inertia.m, 1.5);
  EXPECT_EQ(told(m), "inertia c:6");
}

TEST_F(OddUrdf, WhatIsNotReadIsNamed) {
  const auto said = [&](const std::string& tail, const std::string& inside = "", const std::string& more = "") {
    const Read m = model("continuous", inside, kInertial + more, "", tail);
    return told(m) + "|" + text(m);
  };
  for (const char* element :
       {"<loop_joint name=\"x\" type=\"spherical\"><link1 link=\"a\"/></loop_joint>",
        "<drake:ball_constraint name=\"x\"/>", "<gear name=\"x\" ratio=\"2\"/>", "<joint_coupling name=\"x\"/>",
        "<gazebo><joint name=\"x\" type=\"revolute\"><parent>a</parent></joint></gazebo>",
        "<gazebo reference=\"b\"><plugin><joint name=\"x\" type=\"gearbox\"/></plugin></gazebo>",
        "<drake:linear_spring_damper name=\"x\"/>"}) {
    const std::string out = said(element);
    EXPECT_EQ(out.find("unread x:6|"), 0u) << element << "\n" << out;
    EXPECT_NE(out.find("influences the motion and is ignored"), std::string::npos) << out;
  }
  // several of one kind are one finding
  EXPECT_EQ(said("<thing/><thing/>\n<thing/>"), "unread thing:6|<thing>, here and in 2 more places, is ignored\n");
  EXPECT_EQ(said("", "<joint_properties friction=\"1\"/>"), "unread j:5|<joint_properties> in <joint> is ignored\n");
  EXPECT_EQ(said("", "<origin xyz=\"1 0 0\" quat_xyzw=\"0 0 0 1\"/>"), "unread j:5|quat_xyzw of <origin> is ignored\n");
  EXPECT_EQ(said("", "<dynamics damping=\"0\" spring_stiffness=\"3\"/>"),
            "unread j:5|spring_stiffness of <dynamics> is ignored\n");
  EXPECT_EQ(said("", "<axis xyz=\"1 0 0\"/><axis xyz=\"0 1 0\"/>"),
            "unread j:5|a second <axis> in <joint> is ignored\n");
  EXPECT_EQ(said("", "", kInertial), "unread b:4|a second <inertial> in <link> is ignored\n");
  EXPECT_EQ(said("<transmission name=\"x\"><joint name=\"j\"/><actuator name=\"m\"><mechanicalReduction>100"
                 "</mechanicalReduction></actuator></transmission>"),
            "unread x:6|<mechanicalReduction> is ignored: use `armature` for rotor inertia\n");
  EXPECT_EQ(said("<gazebo reference=\"j\"><springStiffness>3</springStiffness></gazebo>").find("unread j:6|"), 0u);
  // elements without effect on the motion are ignored silently
  EXPECT_EQ(
      said("<material name=\"x\"/><gazebo reference=\"b\"><mu1>0.2</mu1></gazebo><sensor name=\"s\"/>"
           "<transmission name=\"t\"><actuator><mechanicalReduction>1</mechanicalReduction></actuator></transmission>"
           "<drake:collision_filter_group name=\"c\"/>",
           "<safety_controller k_velocity=\"1\"/><calibration rising=\"0\"/>", "<visual/><collision/><contact/>"),
      "|");
  const Read planar = model("planar", "<limit effort=\"1\" velocity=\"1\"/><dynamics damping=\"1\"/>");
  EXPECT_EQ(told(planar), "dynamics j:5\nunread j:5");
}

TEST_F(OddUrdf, XacroIsRefused) {
  const std::string wanted = "run `xacro ROBOT.urdf.xacro > ROBOT.urdf`";
  for (const char* element : {"<xacro:include filename=\"x\"/>", "<xacro:if value=\"true\"/>", "<xacro:leg/>",
                              "<link name=\"d\"><inertial><xacro:insert_block name=\"x\"/></inertial></link>"}) {
    const std::string said = refusal(robot("continuous", "", kInertial, element));
    EXPECT_EQ(said.find("2: <xacro:"), 0u) << said;
    EXPECT_NE(said.find(wanted), std::string::npos) << said;
  }
  const std::string other = folder_.write(
      "other.urdf",
      "<robot name=\"r\" xmlns:x=\"http://www.ros.org/wiki/xacro\">\n<link name=\"a\"/>\n<x:leg/></robot>");
  EXPECT_EQ(refusal(other).find("3: <x:leg> is an element of xacro"), 0u);
  // output of an xacro run
  EXPECT_EQ(
      refusal(folder_.write("expanded.urdf",
                            "<robot name=\"r\" xmlns:xacro=\"http://wiki.ros.org/xacro\"><link name=\"a\"/></robot>")),
      "accepted");
}

// xacro elements left in shapes and colours do not affect the motion.
TEST_F(OddUrdf, XacroInShapesIsTold) {
  for (const char* inside :
       {"<visual><xacro:insert_block name=\"x\"/></visual>", "<collision><geometry><xacro:box/></geometry></collision>",
        "<visual><material name=\"m\"><xacro:colour/></material></visual>"}) {
    const Read read = load(folder_.write(
        "shapes.urdf", "<robot name=\"r\">\n<link name=\"a\">\n" + std::string(inside) + "</link></robot>"));
    ASSERT_EQ(read.findings.size(), 1u) << inside;
    EXPECT_EQ(read.findings[0].kind, "unread");
    EXPECT_NE(read.findings[0].text.find("is ignored: xacro did not replace this element"), std::string::npos)
        << read.findings[0].text;
  }
}

TEST_F(OddUrdf, FloatingJointsOfTheFileArePassive) {
  const std::string path = robot("floating", "", kInertial, "",
                                 "<link name=\"c\">" + kInertial +
                                     "</link><joint name=\"k\" type=\"continuous\"><parent link=\"b\"/><child "
                                     "link=\"c\"/></joint>");
  const Read m = load(path);
  EXPECT_EQ(m.model.nu(), 1);
  EXPECT_EQ(told(m), "passive j:5");
  UrdfOptions options;
  options.passive = {"j"};
  EXPECT_EQ(told(load(path, options)), "");
  options.passive.clear();
  options.actuated = {"j"};
  const Read flown = load(path, options);
  EXPECT_EQ(flown.model.nu(), 7);
  EXPECT_EQ(told(flown), "");
  options.actuated = {"x"};
  EXPECT_THROW((void)load_urdf(path, options), UrdfOptionError);
  options.actuated = {};
  options.floating_base = true;
  EXPECT_EQ(told(load(path, options)), "base j:5\npassive j:5");

  const auto torques = [&](const std::string& joint) {
    return read_scene(
               folder_.write("scene.xml", "<scene><robot name=\"q\" urdf=\"robot.urdf\">" + joint + "</robot></scene>"))
        .u;
  };
  EXPECT_EQ(torques("").size(), 1);
  EXPECT_EQ(torques("<joint name=\"j\" actuated=\"false\"/>").size(), 1);
  EXPECT_EQ(torques("<joint name=\"j\" actuated=\"true\" u=\"1 2 3 4 5 6\"/>")[2], 3);
  // a planar joint of the file keeps its motors
  EXPECT_EQ(load_urdf(robot("planar", "")).nu(), 3);
}

TEST_F(OddUrdf, SharedReports) {
  const std::string reports = std::string(MANYCONTACT_SHARED_DIR) + "/reports/";
  if (!std::filesystem::exists(reports)) GTEST_SKIP() << reports << " is not here";
  const auto kinds = [&](const std::string& scene) {
    std::string out;
    for (const Finding& f : read_scene(reports + scene).findings) out += f.kind + " " + f.name + ", ";
    return out;
  };
  EXPECT_EQ(kinds("inertia/scene.xml"), "inertia a/upper, ");
  EXPECT_EQ(kinds("limits/rev_inf.xml"), "limits c/spin, ");
  EXPECT_EQ(kinds("limits/wheel_effort.xml"), "limits c/spin, ");
  EXPECT_EQ(kinds("limits/wheel_inf.xml"), "");  // a continuous joint has no lower and upper
  EXPECT_EQ(kinds("floating_in_urdf/scene_gravity.xml"), "passive q/base_to_world, ");
  EXPECT_EQ(kinds("floating_in_urdf/scene_twice.xml"), "base q/base_to_world, passive q/base_to_world, ");
  EXPECT_EQ(kinds("loop_joint/scene.xml"), "unread f/close, unread f/drake:ball_constraint, unread f/t, ");
  EXPECT_EQ(refusal(reports + "xacro/arm.urdf.xacro").find("3: <xacro:include> is an element of xacro"), 0u);
}

}  // namespace
}  // namespace manycontact
