// Every kind of bad input is refused with its file, line and message.

#include <gtest/gtest.h>

#include <random>

#include "manycontact/io/scene_file.hpp"
#include "manycontact/io/urdf.hpp"
#include "support/folder.hpp"

namespace manycontact {
namespace {

std::string link(const std::string& name, const std::string& inertial) {
  return "<link name=\"" + name + "\"><inertial>" + inertial + "</inertial></link>";
}

std::string mass(const std::string& m, const std::string& ixx = "1") {
  return "<mass value=\"" + m + "\"/><inertia ixx=\"" + ixx + "\" ixy=\"0\" ixz=\"0\" iyy=\"1\" iyz=\"0\" izz=\"1\"/>";
}

std::string joint(const std::string& attributes, const std::string& inside = "", const std::string& parent = "a",
                  const std::string& child = "b") {
  return "<joint " + attributes + "><parent link=\"" + parent + "\"/><child link=\"" + child + "\"/>" + inside +
         "</joint>";
}

// Line 1 opens the robot; links a (2), b (3), c (4), d (5); joints r, f, p are on lines 6 to 8.
const std::vector<std::string> kUrdf = {
    R"(<robot name="good">)",
    link("a", mass("1")),
    link("b", mass("1")),
    R"(<link name="c"/>)",
    R"(<link name="d"/>)",
    joint(R"(name="r" type="continuous")", R"(<axis xyz="0 0 1"/>)"),
    joint(R"(name="f" type="fixed")", "", "b", "c"),
    joint(R"(name="p" type="planar")", R"(<axis xyz="0 0 1"/>)", "c", "d"),
    R"(</robot>)",
};

std::string joined(const std::vector<std::string>& lines) {
  std::string text;
  for (const std::string& l : lines) text += l + "\n";
  return text;
}

class BadInput : public testing::Test {
 protected:
  BadInput() { write("good.urdf", joined(kUrdf)); }

  std::string write(const std::string& name, const std::string& text) const { return folder_.write(name, text); }

  template <class Load>
  void expect_error(const Load& load, const std::string& file, int line, const std::string& says) const {
    try {
      load();
      ADD_FAILURE() << "accepted, though '" << says << "' was expected";
    } catch (const InputError& e) {
      const std::string what = e.what();
      EXPECT_EQ(e.file, file);
      EXPECT_EQ(e.line, line) << what;
      EXPECT_EQ(what.find(file + ":" + std::to_string(line) + ": "), 0u) << what;
      EXPECT_NE(what.find(says), std::string::npos) << what << "\nshould say: " << says;
      EXPECT_EQ(what.find('\n'), std::string::npos) << what;
    } catch (const std::exception& e) {
      ADD_FAILURE() << "not an InputError: " << e.what();
    }
  }

  void expect_scene_error(const std::string& text, int line, const std::string& says) const {
    SCOPED_TRACE(text);
    const std::string path = write("scene.xml", text);
    expect_error([&] { (void)read_scene(path); }, path, line, says);
  }

  void expect_urdf_error(const std::string& text, int line, const std::string& says,
                         const UrdfOptions& options = {}) const {
    SCOPED_TRACE(text.substr(0, 2000));
    const std::string path = write("bad.urdf", text);
    expect_error([&] { (void)load_urdf(path, options); }, path, line, says);
  }

  test::TemporaryFolder folder_;
};

TEST(InputError, IsOneLine) {
  const InputError e("a\nb.xml", 0, "bad \t name \x01 here\r\n");
  EXPECT_STREQ(e.what(), "a b.xml:1: bad   name   here  ");
  EXPECT_EQ(e.line, 1);
}

// ---- files

TEST_F(BadInput, FilesThatAreNotXml) {
  expect_scene_error("", 1, "is empty, expected XML with one root element <scene>");
  expect_scene_error("  \n \n", 1, "is empty");
  expect_scene_error("hello", 1, "is not XML");
  expect_scene_error("<scene>\n<robot>\n</scene>", 2, "mismatched element");
  expect_scene_error("<scene>\n\n<robot name=1/></scene>", 3, "is not XML");
  expect_scene_error("<scene", 1, "is not XML");
  expect_scene_error("<!-- nothing -->", 1, "has no element");
  expect_scene_error("\n<robot/>", 2, "has the root element <robot>, expected XML with one root element <scene>");
  expect_scene_error("<scene/>\n<scene/>", 2, "continues outside <scene>");
  expect_scene_error("<scene/>\nmore", 2, "is not XML");
  expect_scene_error(std::string("<scene>\n\0</scene>", 17), 2, "zero byte");
  std::string deep = "<scene>";
  for (int i = 0; i < 100000; ++i) deep += "<a>";
  expect_scene_error(deep, 1, "depth");
  std::string binary;
  std::mt19937 random(1);
  for (int i = 0; i < 5000; ++i) binary += static_cast<char>(1 + random() % 255);
  EXPECT_THROW((void)read_scene(write("scene.xml", binary)), InputError);
}

TEST_F(BadInput, FilesThatAreNotThere) {
  const std::string missing = (folder_ / "none.xml").string();
  expect_error([&] { (void)read_scene(missing); }, missing, 1, "No such file");
  expect_error([&] { (void)read_scene(folder_.path().string()); }, folder_.path().string(), 1, "is a directory");
  expect_error([&] { (void)load_urdf(missing); }, missing, 1, "No such file");
  expect_scene_error("<scene>\n<robot name=\"a\"\n urdf=\"none.urdf\"/></scene>", 3, "No such file");
  expect_scene_error("<scene>\n<robot name=\"a\" urdf=\".\"/></scene>", 2, "is a directory");
}

TEST_F(BadInput, ABadUrdfIsBlamedItself) {
  const std::string urdf = write("bad.urdf", "<robot name=\"x\">\n<link/></robot>");
  const std::string scene = write("scene.xml", "<scene><robot name=\"a\" urdf=\"bad.urdf\"/></scene>");
  expect_error([&] { (void)read_scene(scene); }, urdf, 2, "<link> has no attribute 'name'");
}

// ---- scenes: robots

struct SceneCase {
  const char* attributes;  // of the robot on line 3
  const char* inside;      // from line 4 on
  int line;
  const char* says;
};

TEST_F(BadInput, Robots) {
  const SceneCase cases[] = {
      {R"(colour="red")", "", 3, "<robot> has an unknown attribute 'colour'"},
      {R"(base="floating" base="fixed")", "", 3, "an attribute that is malformed or given twice"},
      {R"(base="Fixed")", "", 3, "base of <robot> is 'Fixed', expected one of 'floating', 'fixed'"},
      {R"(mimic="no")", "", 3, "mimic of <robot> is 'no'"},
      {R"(u="1")", "", 3, "u of <robot> is '1', expected 'gravity'"},
      {R"(xyz="0 0")", "", 3, "xyz of <robot> has 2 numbers, expected 3"},
      {R"(rpy="0 0 0 0")", "", 3, "rpy of <robot> has 4 numbers, expected 3"},
      {R"(xyz="0 0 x")", "", 3, "'x' is not a number"},
      {R"(xyz="0,5 0 1")", "", 3, "'0,5' is not a number"},
      {R"(xyz="0 0 1f")", "", 3, "'1f' is not a number"},
      {R"(xyz="0 0 0x1p3")", "", 3, "is not a number"},
      {R"(xyz="0 0 +-1")", "", 3, "is not a number"},
      {R"(xyz="0 0 nan")", "", 3, "'nan' is not finite"},
      {R"(xyz="0 0 -inf")", "", 3, "'-inf' is not finite"},
      {R"(xyz="0 0 1e999")", "", 3, "'1e999' is too large"},
      {R"(armature="-1")", "", 3, "armature of <robot> is -1, expected 0 or more"},
      {R"(armature="")", "", 3, "armature of <robot> is empty, expected a number"},
      {R"(armature="1 2")", "", 3, "is not one number"},
      {R"(copies="0")", "", 3, "expected a whole number from 1 to 1000000"},
      {R"(copies="-2")", "", 3, "expected a whole number from 1 to 1000000"},
      {R"(copies="1000001")", "", 3, "expected a whole number from 1 to 1000000"},
      {R"(copies="99999999999999999999")", "", 3, "expected a whole number"},
      {R"(copies="2.5")", "", 3, "expected a whole number"},
      {R"(copies="1.5")", "", 3, "copies of <robot> is '1.5', expected a whole number from 1 to 1000000"},
      {R"(copies="1e7")", "", 3, "copies of <robot> is '1e7', expected a whole number from 1 to 1000000"},
      {R"(copies="1e-1")", "", 3, "expected a whole number"},
      {R"(copies="1e999")", "", 3, "expected a whole number"},
      {R"(copies="nan")", "", 3, "expected a whole number"},
      {R"(copies="1e2 1e2")", "", 3, "expected a whole number"},
      {R"(copies="two")", "", 3, "expected a whole number"},
      {R"(copies="2" arrange="ring")", "", 3, "arrange of <robot> is 'ring'"},
      {R"(copies="2" spacing="-1")", "", 3, "spacing of <robot> is -1, expected 0 or more"},
      {R"(arrange="line")", "", 3, "arrange of <robot> needs copies"},
      {R"(spacing="1")", "", 3, "spacing of <robot> needs copies"},
      {"", "text", 3, "<robot> contains the text 'text"},
      {"", "<link/>", 4, "<robot> contains an unknown element <link>"},
      {"", "<joint q=\"1\"/>", 4, "<joint> has no attribute 'name'"},
      {"", "<joint name=\"x\" q=\"1\"/>", 4, "the robot has no joint 'x', expected one of 'root', 'r', 'p'"},
      {"", "<joint name=\"f\" q=\"1\"/>", 4, "joint 'f' is fixed"},
      {"", "<joint name=\"r\" at=\"1\"/>", 4, "<joint> has an unknown attribute 'at'"},
      {"", "<joint name=\"r\"><q/></joint>", 4, "<joint> contains an unknown element <q>, expected none"},
      {"", "<joint name=\"r\" q=\"1 2\"/>", 4, "q of joint 'r' has 2 numbers, expected 1"},
      {"", "<joint name=\"p\" q=\"1\"/>", 4, "q of joint 'p' has 1 number, expected 3"},
      {"", "<joint name=\"root\" u=\"1\"/>", 4, "joint 'root' is the floating base"},
      {"", "<joint name=\"r\" armature=\"-1\"/>", 4, "armature of joint 'r' is -1"},
      {"", "<joint name=\"r\" armature=\"1 2\"/>", 4, "the armature of joint 'r' has 2 numbers, expected 1"},
      {"", "<joint name=\"f\" armature=\"1\"/>", 4, "joint 'f' is fixed"},
      {"", "<joint name=\"r\" q=\"1\"/>\n<joint name=\"r\" v=\"1\"/>", 5, "joint 'r' has a second <joint>"},
      {"", "<lock joint=\"r\"/>", 4, "<lock> has no attribute 'at'"},
      {"", "<lock at=\"1\"/>", 4, "<lock> has no attribute 'joint'"},
      {"", "<lock joint=\"r\" at=\"x\"/>", 4, "'x' is not a number"},
      {"", "<lock joint=\"x\" at=\"0\"/>", 4, "the robot has no joint 'x' that could be locked"},
      {"", "<lock joint=\"f\" at=\"0\"/>", 4, "joint 'f' is fixed"},
      {"", "<lock joint=\"p\" at=\"0\"/>", 4, "joint 'p' has several coordinates"},
      {"", "<lock joint=\"r\" at=\"0\"/>\n<lock joint=\"r\" at=\"1\"/>", 5, "joint 'r' has a second <lock>"},
      {"", "<lock joint=\"r\" at=\"0\"/>\n<joint name=\"r\" q=\"1\"/>", 5, "joint 'r' is locked"},
      {"", "<lock joint=\"r\" at=\"0\"/>\n<joint name=\"r\" armature=\"1\"/>", 5, "joint 'r' is locked"},
      {"", "<q>1 2 3</q>", 4, "<q> of robot 'a' has 3 numbers, expected 11"},
      {"", "<v/>", 4, "<v> of robot 'a' has 0 numbers, expected 10"},
      {"", "<u>1 2 3 4 5</u>", 4, "<u> of robot 'a' has 5 numbers, expected 4"},
      {"", "<u>1 2 3 x</u>", 4, "'x' is not a number"},
      {"", "<u>1 2 <b/> 3 4</u>", 4, "<u> contains an element <b>, expected numbers"},
      {"", "<u a=\"1\">1 2 3 4</u>", 4, "<u> has an unknown attribute 'a', expected none"},
      {"", "<u>1 2 3 4</u>\n<u>1 2 3 4</u>", 5, "robot 'a' has a second <u>"},
      {"", "<u>1 2 3 4</u>\n<joint name=\"r\" u=\"1\"/>", 5, "joint 'r' has u=, and <u> also gives this value"},
      {"", "<q>0 0 0 0 0 0 1.00001 0 0 0 0</q>", 4, "expected a unit quaternion"},
      {"", "<q>0 0 0 0 0 0 0 0 0 0 0</q>", 4, "has length 0"},
      {"", "<joint name=\"root\" q=\"0 0 0 1 0 0 1\"/>", 4, "expected a unit quaternion"},
      {R"(u="gravity")", "<u>1 2 3 4</u>", 3, "u=\"gravity\" and <u> both give the torques"},
      {R"(u="gravity")", "<joint name=\"r\" u=\"1\"/>", 3, "u=\"gravity\" and u of joint 'r' both"},
      {R"(xyz="0 0 1")", "<q>0 0 0 0 0 0 1 0 0 0 0</q>", 3, "xyz of <robot> and q both place the floating base"},
      {R"(rpy="0 0 1")", "<joint name=\"root\" q=\"0 0 0 0 0 0 1\"/>", 3, "rpy of <robot> and q both place"},
  };
  for (const SceneCase& c : cases) {
    const std::string attributes = c.attributes;
    const std::string base = attributes.find("base=") == std::string::npos ? " base=\"floating\"" : "";
    expect_scene_error("<scene>\n<!-- -->\n<robot name=\"a\" urdf=\"good.urdf\"" + base + " " + attributes + ">" +
                           (std::string(c.inside) == "text" ? "" : "\n") + c.inside + "</robot></scene>",
                       c.line, c.says);
  }
}

TEST_F(BadInput, ScenesAndNames) {
  const std::string a = "<robot name=\"a\" urdf=\"good.urdf\"/>";
  expect_scene_error("<scene gravity=\"0 0\"/>", 1, "gravity of <scene> has 2 numbers, expected 3");
  expect_scene_error("<scene\n damping=\"-1\"/>", 2, "damping of <scene> is -1, expected 0 or more");
  expect_scene_error("<scene tolerance=\"-1\"/>", 1, "tolerance of <scene> is -1, expected 0 or more");
  expect_scene_error("<scene moment_length=\"0\"/>", 1, "moment_length of <scene> is 0, expected a length above 0");
  expect_scene_error("<scene friction=\"1\"/>", 1, "unknown attribute 'friction'");
  expect_scene_error("<scene>\n<body/></scene>", 2, "unknown element <body>, expected one of 'robot', 'contact'");
  expect_scene_error("<scene>\n<robot urdf=\"good.urdf\"/></scene>", 2, "<robot> has no attribute 'name'");
  expect_scene_error("<scene>\n<robot name=\"\" urdf=\"good.urdf\"/></scene>", 2, "is empty");
  expect_scene_error("<scene>\n<robot name=\"a/b\" urdf=\"good.urdf\"/></scene>", 2, "without '/'");
  expect_scene_error("<scene>\n<robot name=\"a+1\" urdf=\"good.urdf\"/></scene>", 2, "without '/' and '+'");
  expect_scene_error("<scene>\n<robot name=\"a\"/></scene>", 2, "<robot> has no attribute 'urdf'");
  expect_scene_error("<scene>\n<robot name=\"a\" urdf=\"\"/></scene>", 2, "urdf of <robot> is empty");
  expect_scene_error("<scene>\n" + a + "\n" + a + "</scene>", 3, "a robot named 'a' exists already on line 2");
  expect_scene_error(
      "<scene>\n<robot name=\"b\" urdf=\"good.urdf\" copies=\"2\"/>\n"
      "<robot name=\"b1\" urdf=\"good.urdf\"/></scene>",
      3, "a robot named 'b1' exists already");
  expect_scene_error(
      "<scene>\n<robot name=\"b1\" urdf=\"good.urdf\" copies=\"2\"/>\n"
      "<robot name=\"b\" urdf=\"good.urdf\" copies=\"11\"/></scene>",
      3, "a robot named 'b10' exists already");
  expect_scene_error(
      "<scene>\n<robot name=\"b\" urdf=\"good.urdf\" copies=\"2\"/>\n"
      "<robot name=\"b0\" urdf=\"good.urdf\" copies=\"2\"/><robot name=\"c\" urdf=\"good.urdf\"/></scene>",
      3, "the copied robot 'b0' has the name of another robot");
}

// If b has copies, b-1/link means a copy's neighbour.
TEST_F(BadInput, NamesOfNeighbours) {
  const auto scene_with = [](const std::string& name, const std::string& more = "") {
    return "<scene>\n<robot name=\"" + name + "\" urdf=\"good.urdf\"" + more +
           "/>\n<robot name=\"b\" urdf=\"good.urdf\" copies=\"2\"/></scene>";
  };
  for (const char* name : {"b-1", "b-007"})
    expect_scene_error(scene_with(name), 2, "has a name that is reserved for neighbours among copies, expected a name");
  for (const char* name : {"b-1", "b-"})
    expect_scene_error(scene_with(name, " copies=\"3\""), 2, "has a name that is reserved for neighbours among copies");
  for (const char* name : {"a-1", "b-", "b-x", "b-1x", "-1"})
    EXPECT_NO_THROW((void)read_scene(write("scene.xml", scene_with(name)))) << name;
}

// ---- scenes: contacts

TEST_F(BadInput, Contacts) {
  struct Case {
    const char* attributes;  // of the contact on line 5
    const char* says;
  };
  const Case cases[] = {
      {R"(type="3d" frame="a/b")", "<contact> has no attribute 'name'"},
      {R"(name="" type="3d" frame="a/b")", "name of <contact> is empty"},
      {R"(name="c" frame="a/b")", "<contact> has no attribute 'type'"},
      {R"(name="c" type="3d")", "<contact> has no attribute 'frame'"},
      {R"(name="c" type="3D" frame="a/b")", "type of <contact> is '3D', expected one of '1d', '2d', '3d', '5d', '6d'"},
      {R"(name="c" type="3d" frame="a/b" friction="1")",
       "<contact> has an unknown attribute 'friction', did you mean 'mu'?"},
      {R"(name="c" type="3d" frame="a/b" quat="0 0 0 1")", "attribute 'quat', did you mean 'quat_xyzw'?"},
      {R"(name="c" type="3d" link="a/b")", "attribute 'link', did you mean 'frame'?"},
      {R"(name="c" type="3d" frame="a/b" activ="true")", "attribute 'activ', did you mean 'active'?"},
      {R"(name="c" type="3d" frame="a/b" reference_frame="LOCAL")", "reference_frame of <contact> is 'LOCAL'"},
      {R"(name="c" type="3d" frame="a/b" active="yes")", "active of <contact> is 'yes'"},
      {R"(name="c" type="3d" frame="a/b" gains="1")", "gains of <contact> has 1 number, expected 2"},
      {R"(name="c" type="3d" frame="a/b" offset="1 2")", "offset of <contact> has 2 numbers, expected 3"},
      {R"(name="c" type="3d" frame="a/b" offset_quat_xyzw="0 0 1")", "has 3 numbers, expected 4"},
      {R"(name="c" type="3d" frame="a/b" offset_quat_xyzw="0 0 1 1")", "expected a unit quaternion"},
      {R"(name="c" type="3d" frame="a/b" quat_xyzw="0 0 0 2")", "has length 2, expected a unit quaternion"},
      {R"(name="c" type="3d" frame="a/b" xyz="1 2 inf")", "is not finite"},
      {R"(name="c" type="3d" frame="a/b" axis="0 0 1")", "a 3d contact has an axis"},
      {R"(name="c" type="5d" frame="a/b" reference_frame="world")", "is 5d in the world's axes"},
      {R"(name="c" type="3d" frame="a/b" mu="-1")", "has a mu that is not 0 or more"},
      {R"(name="c" type="3d" frame="a/b" mu="1" box="1 1")", "is 3d and has a box"},
      {R"(name="c" type="6d" frame="a/b" box="1 1")", "has a box and no mu"},
      {R"(name="c" type="6d" frame="a/b" mu="1" box="-1 1")", "has a box that is not 0 or more"},
      {R"(name="c" type="5d" frame="a/b" mu="1")", "is 5d and has a mu"},
      {R"(name="c" type="1d" frame="a/b" axis="0 0 0")", "contact 'c' has a zero axis, expected a direction"},
      {R"(name="c" type="3d" frame="b")", "frame of <contact> is 'b', expected robot/link"},
      {R"(name="c" type="3d" frame="x/b")", "there is no robot 'x', expected one of 'a', 'h', 'g'"},
      {R"(name="c" type="3d" frame="h2/b")", "there is no robot 'h2'"},
      {R"(name="c" type="3d" frame="a/x")", "robot 'a' has no frame 'x', expected one of 'a', 'b', 'c', 'd'"},
      {R"(name="c" type="3d" frame="h+1/b")", "expected a name without +k or -k"},
      {R"(name="c" type="3d" frame="a/b" to="a/b")", "contact 'c' ties frame 'b' of robot 'a' to itself"},
      {R"(name="c" type="3d" frame="h/b" to="h/b")", "contact 'c0' ties frame 'b' of robot 'h0' to itself"},
      {R"(name="c" type="3d" frame="h/b" to="h+2/b" wrap="true")", "contact 'c0' ties frame 'b' of robot 'h0' to it"},
      {R"(name="c" type="3d" frame="a/b" to="a/c")",
       "ties frame 'b' of robot 'a' to frame 'c' of robot 'a', which are on one body"},
      {R"(name="c" type="3d" frame="a/a")", "fixes frame 'a' of robot 'a', which cannot move, to the world"},
      {R"(name="c" type="3d" frame="a/a" to="h0/a")", "frame 'a' of robot 'a', which cannot move, to the world"},
      {R"(name="c" type="3d" frame="h/a" to="h+1/a")", "frame 'a' of robot 'h0', which cannot move, to the world"},
      {R"(name="c" type="1d" frame="a/b" axis="1e-10 0 0")", "contact 'c' has a zero axis, expected a direction"},
      {R"(name="c" type="3d" frame="a/b" to="y/b")", "there is no robot 'y'"},
      {R"(name="c" type="3d" frame="a/b" to="h/b")", "all copies of a robot, expected one copy"},
      {R"(name="c" type="3d" frame="h0/b" to="h+1/b")", "all copies of a robot, expected one copy"},
      {R"(name="c" type="3d" frame="h/b" to="g/b")", "on 3 copies, expected 2 copies as in 'frame'"},
      {R"(name="c" type="3d" frame="h/b" to="a+1/b")", "robot 'a' is not copied"},
      {R"(name="c" type="3d" frame="h/b" to="h0+1/b")", "robot 'h0' is not copied"},
      {R"(name="c" type="3d" frame="h/b" to="h+x/b")", "there is no robot 'h+x'"},
      {R"(name="c" type="3d" frame="h/b" to="h+/b")", "there is no robot 'h+'"},
      {R"(name="c" type="3d" frame="h/b" to="h+99999999/b")", "beyond all copies"},
      {R"(name="c" type="3d" frame="h/b" to="h+99999999999999999999/b")", "there is no robot"},
      {R"(name="c" type="3d" frame="h/b" to="h/a" wrap="true")", "wrap of <contact> needs a next copy"},
      {R"(name="c" type="3d" frame="h/b" wrap="true")", "wrap of <contact> needs a target"},
      {R"(name="c" type="3d" frame="h/b" to="h+1/b" wrap="1")", "wrap of <contact> is '1'"},
      {R"(name="c" type="3d" frame="a/b" to_offset="0 0 0")", "to_offset of <contact> needs a target"},
      {R"(name="c" type="3d" frame="a/b" to_offset_quat_xyzw="0 0 0 1")", "needs a target"},
      {R"(name="c" type="3d" frame="a/b" to="h0/b" xyz="0 0 0")", "xyz of <contact> places a contact in the world"},
      {R"(name="c" type="3d" frame="a/b" to="h0/b" quat_xyzw="0 0 0 1")", "places a contact in the world"},
      {R"(name="ok" type="3d" frame="a/b")", "a contact named 'ok' exists already on line 4"},
      {R"(name="many1" type="3d" frame="a/b")", "contact 'many1' exists already, expected names used once"},
  };
  for (const Case& c : cases)
    expect_scene_error(
        "<scene><robot name=\"a\" urdf=\"good.urdf\"/>\n<robot name=\"h\" urdf=\"good.urdf\" copies=\"2\"/>\n"
        "<robot name=\"g\" urdf=\"good.urdf\" copies=\"3\"/>\n"
        "<contact name=\"ok\" type=\"3d\" frame=\"a/b\"/><contact name=\"many\" type=\"3d\" frame=\"h/b\"/>\n"
        "<contact " +
            std::string(c.attributes) + "/></scene>",
        5, c.says);
  expect_scene_error("<scene>\n<contact name=\"c\" type=\"3d\" frame=\"a/b\"/></scene>", 2,
                     "there are no names to choose from");
}

// ---- URDF

struct UrdfCase {
  int replaced;    // this line of kUrdf ...
  std::string by;  // ... by this
  int line;
  const char* says;
};

TEST_F(BadInput, Urdf) {
  const std::string r = R"(name="r" type="continuous")", turns = R"(name="r" type="revolute")",
                    slides = R"(name="r" type="prismatic")";
  const auto limit = [](const std::string& attributes) { return "<limit " + attributes + "/>"; };
  const UrdfCase cases[] = {
      {1, "<robot>", 1, "<robot> has no attribute 'name'"},
      {1, R"(<robot name="x" version="7.0">)", 1, "urdfdom refuses the robot"},
      {1, "<model>", 1, "is not XML"},
      {2, "", 5, "joint 'r' is an unknown link 'a', expected one of 'b', 'c', 'd'"},
      {2, "<link/>", 2, "<link> has no attribute 'name'"},
      {2, R"(<link name=""/>)", 2, "name of <link> is empty"},
      {2, R"(<link name="b"/>)", 3, "link 'b' exists already on line 2"},
      {4, R"(<link name="c" name="e"/>)", 4, "an attribute that is malformed or given twice"},
      {4, link("c", mass("1 kg")), 4, "is not one number"},
      {4, link("c", mass("1kg")), 4, "'1kg' is not a number"},
      {4, link("c", mass("nan")), 4, "'nan' is not finite"},
      {4, link("c", mass("inf")), 4, "'inf' is not finite"},
      {4, link("c", mass("1", "1e999")), 4, "'1e999' is too large"},
      {4, link("c", "<origin xyz=\"0 0\"/>" + mass("1")), 4, "xyz of <origin> has 2 numbers, expected 3"},
      {3, link("b", mass("-2")), 3, "link 'b', with the links merged into this link, has the mass -2 kg"},
      {3, link("b", mass("1", "-3")), 3, "the principal moment of inertia -3 kg m^2 (trace -1)"},
      {4, link("c", mass("1", "-3")), 3, "link 'b', with the links merged into this link, has"},
      {3, link("b", "<origin xyz=\"1e200 0 0\"/>" + mass("1e200")), 3, "an inertia that is too large for computation"},
      {6, joint(R"(type="fixed")"), 6, "<joint> has no attribute 'name'"},
      {6, joint(R"(name="f" type="fixed")"), 7, "joint 'f' exists already on line 6"},
      {6, joint(R"(name="r")"), 6, "<joint> has no attribute 'type'"},
      {6, joint(R"(name="r" type="ball")"), 6, "type of <joint> is 'ball'"},
      {6, R"(<joint name="r" type="fixed"><child link="b"/></joint>)", 6, "joint 'r' has no <parent>"},
      {6, R"(<joint name="r" type="fixed"><parent link="a"/></joint>)", 6, "joint 'r' has no <child>"},
      {6, R"(<joint name="r" type="fixed"><parent/></joint>)", 6, "<parent> has no attribute 'link'"},
      {6, joint(r, "", "z"), 6, "the parent of joint 'r' is an unknown link 'z'"},
      {6, joint(r, limit("effort=\"nan\" velocity=\"1\"")), 6, "'nan' is not finite"},
      {6, joint(turns, limit("effort=\"1\" velocity=\"1\" upper=\"nan\"")), 6, "'nan' is not finite"},
      {6, joint(slides, limit("effort=\"1\"\n velocity=\"1\" upper=\"1 m\"")), 7, "is not one number"},
      {6, joint(slides, limit("effort=\"much\"")), 6, "'much' is not a number"},
      {6, joint(r, "<axis xyz=\"0 0 0\"/>"), 6, "the axis of joint 'r' is zero"},
      {6, joint(r, "<axis xyz=\"0 0 1 0\"/>"), 6, "xyz of <axis> has 4 numbers"},
      {6, joint(r, "<origin rpy=\"0 0 ${x}\"/>"), 6, "'${x}' is not a number"},
      {6, joint(r, "<dynamics damping=\"x\"/>"), 6, "'x' is not a number"},
      {6, joint(r, "<mimic/>"), 6, "<mimic> has no attribute 'joint'"},
      {6, "", 3, "link 'b' has no parent, and link 'a' has no parent either, expected one root"},
      {6, joint(r, "", "d"), 7, "joint 'f' closes a cycle through link 'b'"},
      {6, joint(r, "", "b"), 6, "joint 'r' closes a cycle through link 'b'"},
      {8, joint(R"(name="p" type="planar")", "", "a", "c"), 8,
       "link 'c' is the child of joint 'p' and of joint 'f', expected a tree"},
  };
  for (const UrdfCase& c : cases) {
    std::vector<std::string> lines = kUrdf;
    if (!c.by.empty())
      lines[c.replaced - 1] = c.by;
    else
      lines.erase(lines.begin() + c.replaced - 1);
    expect_urdf_error(joined(lines), c.line, c.says);
  }
  expect_urdf_error("<robot name=\"x\">\n</robot>", 1, "the robot has no <link>");
  std::vector<std::string> cycle = kUrdf;
  cycle.erase(cycle.begin() + 1);  // no root at all
  cycle[4] = joint(R"(name="r" type="continuous")", "", "d");
  expect_urdf_error(joined(cycle), 6, "joint 'f' closes a cycle");
}

TEST_F(BadInput, MimicRefused) {
  std::vector<std::string> lines = kUrdf;
  lines[5] = joint(R"(name="r" type="continuous")", "<mimic joint=\"p\"/>");
  const std::string path = write("mimic.urdf", joined(lines));
  const std::string robot = "<scene><robot name=\"a\" urdf=\"mimic.urdf\" mimic=";
  const std::string scene = write("scene.xml", robot + "\"refuse\"/></scene>");
  expect_error([&] { (void)read_scene(scene); }, path, 6, "joint 'r' mimics 'p'");
  write("scene.xml", robot + "\"ignore\"/></scene>");
  EXPECT_NO_THROW((void)read_scene(scene));
  write("scene.xml", robot + "\"refuse\"><lock joint=\"r\" at=\"0\"/></robot></scene>");
  EXPECT_NO_THROW((void)read_scene(scene));
}

// Damaged files are refused or read, without any other effect.
TEST_F(BadInput, DamagedFiles) {
  const std::string scene =
      "<scene name=\"s\" gravity=\"0 0 -9.81\"><robot name=\"h\" urdf=\"bad.urdf\" base=\"floating\" "
      "copies=\"3\" arrange=\"circle\" spacing=\"1\"><joint name=\"r\" q=\"0.4\" armature=\"0.02\"/>"
      "<v>0 0 0 0 0 0 1 1 1 1</v></robot><contact name=\"c\" type=\"6d\" frame=\"h/b\" to=\"h+1/d\" "
      "wrap=\"true\" "
      "to_offset=\"0 0 1\" gains=\"25 10\"/></scene>";
  const std::string urdf = joined(kUrdf);
  std::mt19937 random(7);
  const std::string tokens = "<>/\"'= \n\t0123456789.e-+abcnfh&;!?%s[]\xff\x01";
  const auto damaged = [&](std::string text) {
    for (unsigned k = random() % 4; k > 0; --k) {
      const std::size_t at = random() % text.size();
      switch (random() % 4) {
        case 0:
          text[at] = tokens[random() % tokens.size()];
          break;
        case 1:
          text.insert(at, 1, tokens[random() % tokens.size()]);
          break;
        case 2:
          text.erase(at, 1 + random() % 20);
          break;
        default:
          text.insert(at, text.substr(random() % text.size(), random() % 60));
      }
      if (text.empty()) return text;
    }
    return text;
  };
  int refused = 0;
  constexpr int kTrials = 2000;
  for (int i = 0; i < kTrials; ++i) {
    write("bad.urdf", damaged(urdf));
    const std::string path = write("scene.xml", damaged(scene));
    try {
      const SceneFile s = read_scene(path);
      EXPECT_TRUE(s.q.allFinite() && s.v.allFinite() && s.u.allFinite());
    } catch (const InputError& e) {
      ++refused;
      EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos);
    }
  }
  EXPECT_GT(refused, kTrials / 3);
  EXPECT_LT(refused, kTrials);
}

// ---- poses

TEST_F(BadInput, Poses) {
  const std::string robot = "<scene><robot name=\"r\" urdf=\"good.urdf\"/>\n";
  expect_scene_error(robot + "<pose frame=\"r/b\"/></scene>", 2,
                     "gives no coordinate, expected xyz, rpy or any of x, y, z");
  expect_scene_error(robot + "<pose z=\"0\"/></scene>", 2, "frame");
  expect_scene_error(robot + "<pose frame=\"r/e\" z=\"0\"/></scene>", 2, "robot 'r' has no frame 'e'");
  expect_scene_error(robot + "<pose frame=\"b\" z=\"0\"/></scene>", 2, "expected robot/link");
  expect_scene_error(robot + "<pose frame=\"r/a\" z=\"0\"/></scene>", 2,
                     "which cannot move, expected a frame that moves");
  expect_scene_error(robot + "<pose frame=\"r/b\" xyz=\"0 0 1\"\n z=\"0\"/></scene>", 3,
                     "is given with xyz, expected only one of the two");
  expect_scene_error(robot + "<pose frame=\"r/b\" yaw=\"1\" rpy=\"0 0 1\"/></scene>", 2, "is given with rpy");
  expect_scene_error(robot + "<pose frame=\"r/b\" z=\"low\"/></scene>", 2, "low");
  expect_scene_error(robot + "<pose frame=\"r/b\" xyz=\"0 1\"/></scene>", 2, "has 2 numbers, expected 3");
  expect_scene_error(robot + "<pose frame=\"r/b\" z=\"0\" weight=\"1\"/></scene>", 2, "weight");
  expect_scene_error(
      "<scene><robot name=\"r\" urdf=\"good.urdf\" base=\"floating\" copies=\"2\"/>\n<pose frame=\"r+1/b\" "
      "z=\"0\"/></scene>",
      2, "expected a name without +k or -k");
}

TEST_F(BadInput, PushesAndSprings) {
  const auto scene = [](const std::string& element, const std::string& joint = "") {
    return "<scene>\n<robot name=\"r\" urdf=\"good.urdf\">" + joint + "</robot>\n" + element + "\n</scene>\n";
  };
  const auto expect = [&](const std::string& element, const std::string& says) {
    expect_scene_error(scene(element), 3, says);
  };
  expect(R"(<push force="1 0 0"/>)", "<push> has no attribute 'frame'");
  expect(R"(<push frame="r/x"/>)", "frame of <push>: robot 'r' has no frame 'x'");
  expect(R"(<push frame="q/b"/>)", "there is no robot 'q'");
  expect(R"(<push frame="r+1/b"/>)", "is not copied");
  expect(R"(<push frame="r/b" force="1 0"/>)", "force of <push>");
  expect(R"(<push frame="r/b" torque="1 0 nan"/>)", "torque of <push>");
  expect(R"(<push frame="r/b" to="r/d"/>)", "attribute 'to'");
  expect(R"(<push frame="r/b" reference_frame="body"/>)", "reference_frame of <push>");
  expect(R"(<push frame="r/b"><x/></push>)", "<x>");
  expect(R"(<push frame="r/a"/>)", "cannot move");
  expect(R"(<push frame="r/b" name=""/>)", "name of <push> is empty");
  expect(R"(<push frame="r/b"/><push frame="r/b"/>)", "wrench 'r/b' exists already");
  expect(R"(<spring frame="r/b" to="r/d"/>)", "<spring> has no attribute 'stiffness'");
  expect(R"(<spring frame="r/b" stiffness="1"/>)", "neither 'to' nor xyz");
  expect(R"(<spring frame="r/b" to="r/d" xyz="0 0 0" stiffness="1"/>)", "both 'to' and xyz");
  expect(R"(<spring frame="r/b" xyz="0 0 0" to_offset="0 0 0" stiffness="1"/>)",
         "to_offset of <spring> needs a target");
  expect(R"(<spring frame="r/b" to="r/d" stiffness="-1"/>)", "stiffness of <spring> is -1, expected 0 or more");
  expect(R"(<spring frame="r/b" to="r/d" stiffness="1" length="-1"/>)", "length of <spring> is -1");
  expect(R"(<spring frame="r/b" to="r/d" stiffness="1" damping="-1"/>)", "damping of <spring> is -1");
  expect(R"(<spring frame="r/b" to="r/c" stiffness="1"/>)", "which are on one body");
  expect(R"(<spring frame="r/a" xyz="0 0 0" stiffness="1"/>)", "nothing can move");
  const auto expect_joint = [&](const std::string& joint, const std::string& says) {
    expect_scene_error(scene("", joint), 2, says);
  };
  expect_joint(R"(<joint name="r" rest="1"/>)", "rest of <joint> needs a spring");
  expect_joint(R"(<joint name="r" stiffness="-1"/>)", "stiffness of <joint> is -1, expected 0 or more");
  expect_joint(R"(<joint name="r" stiffness="x"/>)", "stiffness of <joint>");
  expect_joint(R"(<joint name="p" stiffness="1"/>)", "joint 'p' of robot 'r' has several coordinates");
  expect_joint(R"(<joint name="r" damping="-1"/>)", "the damping of joint 'r' is -1, expected 0 or more");
  expect_joint(R"(<joint name="p" damping="1"/>)", "joint 'p' has a damping and several coordinates");
  expect_joint(R"(<joint name="f" stiffness="1"/>)", "joint 'f' is fixed");
}

}  // namespace
}  // namespace manycontact
