// `manycontact inspect` prints ranks, correct advice, and the picture.

#include <cmath>
#include <set>

#include "cli/program.hpp"

namespace manycontact::cli {
namespace {

class Inspect : public Program {
 protected:
  std::string inspect(const std::string& scene) const {
    const Outcome outcome = run({"inspect", scene});
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_EQ(outcome.err, "");
    return outcome.out;
  }
};

constexpr char kHumanoid[] = R"(<robot name="h" urdf="humanoid.urdf" base="floating" xyz="0 0 0.7884">
  <joint name="left_knee" q="0.8"/> <joint name="right_knee" q="0.6"/> <joint name="left_elbow" q="-0.5" v="1"/></robot>
)";

// Springs and wrenches are listed with places, lengths and forces; a body that hangs on springs is not free.
TEST_F(Inspect, ListsSpringsAndPushes) {
  const std::string file = scene(
      "<robot name=\"load\" urdf=\"box.urdf\" base=\"floating\"/><spring frame=\"load/crate\" "
      "xyz=\"0 0 2\" stiffness=\"100\" length=\"0.8\"/><push name=\"hand\" frame=\"load/crate\" force=\"1 2 3\"/>");
  const Outcome outcome = run({"inspect", file});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  expect_contains(outcome.out, "load/crate 0 0 0 the world 0 0 2 2 0.8 120");
  expect_contains(outcome.out, "hand load/crate 0 0 0 1 2 3 0 0 0 local");
  EXPECT_EQ(outcome.out.find("floats free"), std::string::npos) << outcome.out;
}

TEST_F(Inspect, FeetOnCorners) {
  const std::string out = inspect(model("feet_on_corners.xml"));
  expect_contains(out, "the 24 contact rows of humanoid have rank 12");
  expect_contains(
      out,
      "left_2[1], left_3[0], left_3[1], left_4[0], left_4[1], left_4[2], right_2[1], right_3[0], right_3[1], "
      "right_4[0], right_4[1], right_4[2]");
  expect_contains(out, "left_1, left_2 as 2d (x and z), left_3 as 1d along z, right_1");
  expect_contains(out, "to be dropped: left_4, right_4");
  expect_contains(
      out, "left_1 .. left_4, 12 rows of rank 6: one 6D contact on `humanoid/left_sole` imposes the same constraint");
  expect_contains(
      out,
      "right_1 .. right_4, 12 rows of rank 6: one 6D contact on `humanoid/right_sole` imposes the same constraint");
  expect_contains(out, "12 rows replace 24");
}

// Following the advice changes no acceleration.
TEST_F(Inspect, AdviceOnRowsHolds) {
  const auto corners = [](const std::vector<std::string>& types) {
    const char* offsets[] = {"0.12 0.045 0", "0.12 -0.045 0", "-0.12 -0.045 0", "-0.12 0.045 0"};
    std::string contacts;
    for (std::size_t k = 0; k < types.size(); ++k)
      contacts += "<contact name=\"c" + std::to_string(k) + "\" " + types[k] + " frame=\"h/left_sole\" offset=\"" +
                  offsets[k] + "\"/>\n";
    return kHumanoid + contacts;
  };
  const std::string threeD = "type=\"3d\"";
  const std::string all = corners({threeD, threeD, threeD, threeD});
  expect_contains(inspect(scene(all)), "c0, c1 as 2d (x and z), c2 as 1d along z; to be dropped: c3");
  const auto a = solve({scene(all)});
  const auto b = solve({scene(corners({threeD, "type=\"2d\"", "type=\"1d\" axis=\"0 0 1\""}))});
  const auto c = solve({scene(std::string(kHumanoid) + "<contact name=\"c\" type=\"6d\" frame=\"h/left_sole\"/>")});
  EXPECT_EQ(a.at("report").at("rank"), 6);
  EXPECT_EQ(b.at("report").at("status"), "ok");
  EXPECT_EQ(c.at("report").at("status"), "ok");
  for (std::size_t k = 0; k < a.at("acceleration").size(); ++k) {
    const double x = a.at("acceleration")[k];
    EXPECT_NEAR(b.at("acceleration")[k], x, 1e-8 * (1 + std::abs(x)));
    EXPECT_NEAR(c.at("acceleration")[k], x, 1e-8 * (1 + std::abs(x)));
  }
}

TEST_F(Inspect, PointsOnALineHoldFiveMotions) {
  const std::string out = inspect(scene(std::string(kHumanoid) + R"(
    <contact name="l1" type="3d" frame="h/left_sole" offset="0.1 0 0"/>
    <contact name="l2" type="3d" frame="h/left_sole" offset="-0.1 0 0"/>)"));
  expect_contains(out, "l1, l2, 6 rows of rank 5: points on a line constrain five motions");
  expect_contains(out, "no single contact type imposes this constraint");
  expect_lacks(out, "6D contact on");
}

TEST_F(Inspect, DuplicatesAreOneContact) {
  const std::string out = inspect(scene(std::string(kHumanoid) + R"(
    <contact name="d1" type="3d" frame="h/right_sole"/>
    <contact name="d2" type="3d" frame="h/right_sole" reference_frame="world"/>
    <contact name="p1" type="2d" frame="h/left_hand"/> <contact name="p2" type="1d" axis="0 1 0" frame="h/left_hand"/>
    <contact name="p3" type="1d" axis="1 1 1" frame="h/left_hand"/>
    <contact name="off" type="6d" frame="h/right_hand" active="false"/>)"));
  expect_contains(out, "d1, d2, 6 rows of rank 3: `d1` alone imposes the same constraint");
  expect_contains(out,
                  "p1, p2, p3, 4 rows of rank 3: one 3D contact on `h/left_hand`, at their common point, imposes the "
                  "same constraint");
  expect_contains(out, "6 rows replace 10");
  expect_contains(out, "contacts not active: off");
}

TEST_F(Inspect, SoundScenesGetNoAdviceOnContacts) {
  for (const char* name : {"humanoid_standing.xml", "humanoid_hands_and_feet.xml", "quadruped_loop.xml",
                           "two_humanoids_carry_beam.xml", "arm_pushes_box.xml", "herd.xml", "ring_of_humanoids.xml"}) {
    const std::string out = inspect(model(name));
    for (const char* part : {"redundant", "imposes the same constraint", "have rank", "has rank"})
      expect_lacks(out, part);
    for (const std::string& line : lines_of(out)) EXPECT_TRUE(line.size() <= 100 || line.starts_with("Scene ")) << line;
  }
}

TEST_F(Inspect, HerdAndRingAreSummedUp) {
  const std::string herd = inspect(model("herd.xml"));
  expect_contains(herd, "64 herd0 .. herd63 18 12 12");
  expect_contains(herd, "64 herd0/LF_foot world LF0 3d 3 3");
  const std::string ring = inspect(model("ring_of_humanoids.xml"));
  expect_contains(ring, "1 ring x16 608 288 288");
  expect_contains(ring, "16 ring0/left_hand ring1/right_hand hold0 6d 6 6");
}

// Each contact is listed with its constraint, place, gains, and the state's distance from it.
TEST_F(Inspect, ContactsAreListed) {
  const std::string out = inspect(scene(R"(<robot name="b" urdf="box.urdf" base="floating" xyz="1 2 3"/>
    <robot name="c" urdf="box.urdf" base="floating" xyz="0 0 5" copies="5"/>
    <contact name="far" type="3d" frame="b/crate" xyz="1 2 3.25" gains="25 10" mu="0.7" reference_frame="world"/>
    <contact name="turned" type="6d" frame="b/crate" to="c0/crate" to_offset="1 2 -2"
             to_offset_quat_xyzw="0 0 1 0" active="false"/>
    <contact name="each" type="1d" frame="c/crate"/>)"));
  expect_contains(out, "far 3d world b/crate world 1.00 2.00 3.00 25 10 0.7 world z 0.25 m");
  expect_contains(out, "turned 6d local b/crate c0/crate 1.00 2.00 3.00 0 0 3.14 rad not active");
  expect_contains(out, "each0 .. each4 1d local c0/crate world 0.00 0.00 5.00 0 0 0");
}

// The part cut out of the middle of two names is not their difference.
TEST_F(Inspect, LongNamesStayApart) {
  const std::string before(20, 'x'), after(20, 'y');
  std::string robots;
  for (const char* middle : {"left", "right"})
    robots += "<robot name=\"" + before + middle + after + "\" urdf=\"box.urdf\" base=\"floating\"/>";
  const std::string path_of = scene(robots);
  for (const std::string command : {"inspect", "solve"}) {
    const std::vector<std::string> lines = lines_of(run({command, path_of}).out);
    std::set<std::string> names;
    for (const std::string& line : lines)
      if (line.starts_with("  xxx") && line.find("box.urdf") != std::string::npos) names.insert(line);
    EXPECT_EQ(names.size(), 2u) << command;
  }
}

// Offsets may be nearer to another frame.
TEST_F(Inspect, FramesAreCalledAsTheFileDoes) {
  const std::string out = inspect(scene(R"(<robot name="b" urdf="box.urdf" base="floating"/>
    <robot name="c" urdf="box.urdf" base="floating" xyz="0 0 0.5"/>
    <contact name="hold" type="3d" frame="b/crate" offset="0.2 0.2 0.2"/>
    <contact name="tie" type="6d" frame="c/face_left" offset="0.2 -0.2 0" to="b/bottom_3" to_offset="0.2 0.2 0.4"/>)"));
  expect_contains(out, "b/crate world hold 3d 3 3");
  expect_contains(out, "c/face_left b/bottom_3 tie 6d 6 6");
}

// A humanoid has 38 velocities, 32 torques and 12 rows: 50 x 108 numbers.
TEST_F(Inspect, MemoryOfARobot) {
  const std::string feet =
      "<contact name=\"l\" type=\"6d\" frame=\"h/left_sole\"/>"
      "<contact name=\"r\" type=\"6d\" frame=\"h/right_sole\"/>";
  const std::string out = inspect(scene(kHumanoid + feet));
  if (out.find("Memory per robot: ") == std::string::npos) GTEST_SKIP() << "the heap does not tell";
  expect_contains(out, "kB to solve, and 43.2 kB for all derivatives");
}

TEST_F(Inspect, CostsAreRelativeToTheCheapest) {
  for (const std::string& path : model_scenes()) {
    const std::vector<std::string> lines = lines_of(inspect(path));
    const auto title = std::find_if(lines.begin(), lines.end(), [](const auto& l) { return l.starts_with("Cost of"); });
    ASSERT_NE(title, lines.end());
    expect_contains(*title, "predicted, relative to the cheapest sparse method");
    double least = INFINITY;
    for (auto line = title; line != lines.end(); ++line)
      for (const char* order : {"leaf-to-root", "contacts-early", "camd"}) {
        std::istringstream words(*line);
        std::string first, nonzeros;
        double ldl, cholmod;
        if (!(words >> first >> nonzeros >> ldl >> cholmod) || first != order) continue;
        least = std::min({least, ldl, cholmod});
      }
    EXPECT_EQ(least, 1) << path;
  }
}

TEST_F(Inspect, CostsAndChoiceAreShown) {
  const std::string out = inspect(model("two_humanoids_carry_beam.xml"));
  expect_lacks(out, " us ");
  for (const char* part : {"leaf-to-root", "contacts-early", "camd", "sparse-cholmod", "dense", "auto chooses"})
    expect_contains(out, part);
}

TEST_F(Inspect, WaysToSolveAreListed) {
  expect_contains(
      inspect(model("humanoid_standing.xml")),
      "solve tries these methods until one is accurate: in a SIMD batch; sparse-ldl in leaf-to-root order;");
  expect_contains(inspect(model("ring_of_humanoids.xml")), "robot by robot in SIMD batches;");
}

TEST_F(Inspect, IdleRobotsAndJoints) {
  const std::string out = inspect(scene(R"(<robot name="idle" urdf="arm.urdf" base="fixed"/>
    <robot name="busy" urdf="arm.urdf" base="fixed"><joint name="shoulder_yaw" v="1"/></robot>
    <robot name="box" urdf="box.urdf" base="floating"/>)",
                                        "gravity=\"0 0 0\""));
  expect_contains(out, "idle: the robot is fixed to the world, at rest and without contact");
  expect_contains(out, "box: the robot floats freely, without contact");
  expect_lacks(out, "busy: the robot is fixed to the world");
  expect_contains(inspect(model("feet_on_corners.xml")), "20 joints could be locked");
}

// Checks only that tags are balanced and attributes quoted.
void expect_well_formed(const std::string& text) {
  std::vector<std::string> open;
  int elements = 0;
  for (std::size_t i = text.find('<'); i != std::string::npos; i = text.find('<', i)) {
    const std::size_t end = text.find('>', i);
    ASSERT_NE(end, std::string::npos);
    const std::string tag = text.substr(i + 1, end - i - 1);
    i = end;
    if (tag.starts_with("?")) continue;
    ASSERT_EQ(tag.find('<'), std::string::npos) << tag;
    ASSERT_EQ(std::count(tag.begin(), tag.end(), '"') % 2, 0) << tag;
    const std::string name = tag.substr(0, tag.find_first_of(" /", 1));
    if (tag.starts_with("/")) {
      ASSERT_FALSE(open.empty());
      EXPECT_EQ("/" + open.back(), tag);
      open.pop_back();
    } else {
      ++elements;
      if (!tag.ends_with("/")) open.push_back(name);
    }
  }
  EXPECT_TRUE(open.empty());
  EXPECT_GT(elements, 10);
}

TEST_F(Inspect, PictureIsWellFormedAndSmall) {
  for (const std::string& scene : model_scenes()) {
    SCOPED_TRACE(scene);
    const Outcome outcome = run({"inspect", scene, "--picture", path("k.svg")});
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    const std::string svg = read_text(path("k.svg"));
    EXPECT_TRUE(svg.starts_with("<?xml"));
    EXPECT_LT(svg.size(), 1000000u);
    EXPECT_EQ(svg.find("nan"), std::string::npos);
    expect_well_formed(svg);
  }
  const std::string svg = read_text(path("k.svg"));  // that of the last scene
  for (const char* part : {"two_humanoids_carry_beam", "a_left_foot", "n = 130", "contact rows J", "fill"})
    EXPECT_NE(svg.find(part), std::string::npos) << part;
}

TEST_F(Inspect, PictureEscapesNames) {
  const std::string scene = this->scene(R"(<robot name="a&lt;b&amp;" urdf="box.urdf" base="floating"/>
    <contact name="&quot;c&gt;" type="3d" frame="a&lt;b&amp;/top_1"/>)");
  EXPECT_EQ(run({"inspect", scene, "--picture", path("k.svg")}).status, 0);
  expect_well_formed(read_text(path("k.svg")));
}

TEST_F(Inspect, PictureIsUtf8) {
  const std::string scene = this->scene("<robot name=\"caf\xc3\xa9\" urdf=\"box.urdf\" base=\"floating\"/>");
  EXPECT_EQ(run({"inspect", scene, "--picture", path("k.svg")}).status, 0);
  const std::string svg = read_text(path("k.svg"));
  EXPECT_NE(svg.find("caf\xc3\xa9"), std::string::npos);
}

}  // namespace
}  // namespace manycontact::cli
