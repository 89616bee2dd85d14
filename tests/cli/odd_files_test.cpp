// Files are questionable but usable: the program warns of some and refuses others.

#include "cli/program.hpp"

namespace manycontact::cli {
namespace {

using nlohmann::json;

class OddFiles : public Program {
 protected:
  // Writes an arm of one link, on line 3, whose joint is on line 4; both as given.
  std::string arm(const std::string& link, const std::string& joint, const std::string& attributes = "",
                  const std::string& more = "") const {
    std::ofstream(path("odd.urdf")) << "<robot name=\"arm\">\n<link name=\"base\"/>\n<link name=\"upper\">" << link
                                    << "</link>\n<joint name=\"j\" " << joint
                                    << "<parent link=\"base\"/><child link=\"upper\"/></joint>\n"
                                    << more << "</robot>";
    return scene("<robot name=\"r\" urdf=\"odd.urdf\" " + attributes + "/>");
  }
  static std::string body(double xx, double yy, double zz) {
    std::ostringstream out;
    out << "<inertial><origin xyz=\"0.1 0 0\"/><mass value=\"1.5\"/><inertia ixx=\"" << xx
        << "\" ixy=\"0\" ixz=\"0\" iyy=\"" << yy << "\" iyz=\"0\" izz=\"" << zz << "\"/></inertial>";
    return out.str();
  }
  json finding(const json& solved, const std::string& kind) const {
    for (const json& f : solved.at("findings"))
      if (f.at("kind") == kind) return f;
    ADD_FAILURE() << "no finding of kind " << kind << " in " << solved.at("findings");
    return json::object();
  }
};

TEST_F(OddFiles, AnInertiaThatNoBodyHas) {
  const std::string link = body(0.0019, 0.0085, 0.0106), joint = "type=\"continuous\"><axis xyz=\"0 1 0\"/>";
  const std::string odd = arm(link, joint);
  const json solved = solve({odd});
  EXPECT_NEAR(solved.at("acceleration")[0].get<double>(), 1.5 * 9.81 * 0.1 / (0.0085 + 1.5 * 0.01), 1e-12);
  const json f = finding(solved, "inertia");
  EXPECT_EQ(f.at("name"), "r/upper");
  EXPECT_EQ(f.at("file"), path("odd.urdf"));
  EXPECT_EQ(f.at("line"), 3);
  for (const char* command : {"solve", "inspect"})
    expect_contains(
        run({command, odd}).out,
        "Warnings inertia: r/upper (odd.urdf:3): the body, with the bodies merged into this body, has the principal "
        "moments of inertia 0.0019, 0.0085, 0.0106 kg m^2, which violate the triangle inequality");
  const Outcome refused = run({"solve", arm(link, joint, "inertia=\"refuse\"")});
  EXPECT_EQ(refused.status, 2);
  EXPECT_EQ(refused.err.find("manycontact: " + path("odd.urdf") +
                             ":3: link 'upper', with the links merged into this link, has "),
            0u)
      << refused.err;
}

TEST_F(OddFiles, LimitsThatBoundNothing) {
  const std::string odd = arm(body(1, 1, 1), "type=\"revolute\"><limit lower=\"-Inf\" upper=\"1e999\" effort=\"2\"/>");
  EXPECT_EQ(finding(solve({odd}), "limits").at("text"),
            "<limit> has no velocity, lower -Inf, upper 1e999, where the joint is taken as unlimited");
  expect_contains(run({"inspect", odd}).out, "limits: r/j (odd.urdf:4): <limit> has no velocity");
  // thirty identical ones are one line, thirty different ones a few lines
  std::string many, different;
  for (int i = 0; i < 30; ++i) {
    const std::string n = std::to_string(i);
    many += "<link name=\"l" + n + "\">" + body(1, 1, 1) + "</link><joint name=\"j" + n +
            "\" type=\"continuous\"><parent link=\"base\"/><child link=\"l" + n + "\"/><limit effort=\"1\"/></joint>\n";
    different += "<link name=\"l" + n + "\">" + body(1, 1, 1) + "</link><joint name=\"j" + n +
                 "\" type=\"continuous\"><parent link=\"base\"/><child link=\"l" + n +
                 "\"/><limit velocity=\"1\" effort=\"-1" + n + "\"/></joint>\n";
  }
  const std::string joint = "type=\"continuous\">";
  expect_contains(run({"inspect", arm(body(1, 1, 1), joint, "", many)}).out, "and 26 more: <limit> has");
  const std::string said = run({"inspect", arm(body(1, 1, 1), joint, "", different)}).out;
  expect_contains(said, "limits: there are 26 more such findings");
  EXPECT_EQ(solve({path("scene.xml")}).at("findings").size(), 30u);
}

TEST_F(OddFiles, ASingularInertiaSaysWhy) {
  const auto why = [&](const std::string& link, const std::string& joint, const std::string& attributes = "",
                       const std::string& more = "") {
    const std::string odd = arm(link, joint, attributes, more);
    const json f = finding(solve({odd}, 1), "no_inertia");
    expect_contains(run({"solve", odd}).out, "joints without inertia: ");
    return f.at("name").get<std::string>() + ": " + f.at("text").get<std::string>();
  };
  const std::string y = "type=\"continuous\"><axis xyz=\"0 1 0\"/>";
  EXPECT_EQ(why("", y), "r/j: there is no mass below the joint");
  EXPECT_EQ(why("<inertial><mass value=\"1\"/></inertial>", y),
            "r/j: the joint's bodies lack a moment of inertia about the joint's axis");
  EXPECT_EQ(why("<inertial><inertia ixx=\"1\" iyy=\"1\" izz=\"1\"/></inertial>", "type=\"prismatic\">"),
            "r/j: the joint's bodies lack mass");
  EXPECT_EQ(why("", y, "",
                "<link name=\"l\">" + body(1, 1, 1) +
                    "</link><joint name=\"k\" type=\"continuous\"><parent link=\"upper\"/><child link=\"l\"/><axis "
                    "xyz=\"0 1 0\"/></joint>"),
            "r/j: the joint's bodies lack a moment of inertia about the joint's axis, and the joints below can move "
            "all other bodies");
  // two bases
  EXPECT_EQ(
      why(body(1, 1, 1), "type=\"floating\">", "base=\"floating\""),
      "r/root: the joint's bodies lack mass or a moment of inertia, and the joints below can move all other bodies");
  expect_contains(run({"solve", path("scene.xml")}).out,
                  "base: r/j (odd.urdf:4): the joint is floating and below the floating base: the robot has two bases");
}

TEST_F(OddFiles, NoMotorsHoldAFloatingJoint) {
  const json solved = solve({arm(body(1, 1, 1), "type=\"floating\">", "u=\"gravity\"")});
  EXPECT_NEAR(solved.at("acceleration")[2].get<double>(), -9.81, 1e-12);
  EXPECT_EQ(finding(solved, "passive").at("name"), "r/j");
}

TEST_F(OddFiles, XacroAndEncodings) {
  const Outcome xacro = run({"solve", arm("", "type=\"continuous\">", "", "<xacro:leg/>")});
  EXPECT_EQ(xacro.status, 2);
  EXPECT_EQ(lines_of(xacro.err).size(), 1u);
  expect_contains(xacro.err, path("odd.urdf") + ":5: <xacro:leg> is an element of xacro");
  std::ofstream(path("u.urdf")) << "<?xml version=\"1.0\" encoding=\"ISO-8859-1\"?><robot name=\"r\"><link name=\"a\"/>"
                                   "<link name=\"b\">" +
                                       body(1, 1, 1) +
                                       "</link><joint name=\"\xFC\" "
                                       "type=\"continuous\"><parent link=\"a\"/><child link=\"b\"/></joint></robot>";
  EXPECT_EQ(solve({scene("<robot name=\"r\" urdf=\"u.urdf\"/>")}).at("velocity_names")[0], "r/\xC3\xBC");
}

class CsvFiles : public OddFiles {
 protected:
  // Returns the speed of the arm after 0.1 s without gravity, with torques on a joint of unit inertia.
  double speed(const std::string& csv) {
    const Outcome outcome = simulate(csv);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    const std::string last = lines_of(read_text(path("t.csv"))).back();
    return std::stod(last.substr(last.find(',', last.find(',') + 1) + 1));  // t, q, v
  }
  std::string refusal(const std::string& csv) {
    const Outcome outcome = simulate(csv);
    EXPECT_EQ(outcome.status, 2);
    EXPECT_EQ(lines_of(outcome.err).size(), 1u) << outcome.err;
    return outcome.err;
  }

 private:
  Outcome simulate(const std::string& csv) {
    std::ofstream(path("odd.urdf")) << "<robot name=\"r\"><link name=\"a\"/><link name=\"b\"><inertial><mass "
                                       "value=\"0\"/><inertia ixx=\"1\" iyy=\"1\" izz=\"1\"/></inertial></link><joint "
                                       "name=\"j\" type=\"continuous\"><parent link=\"a\"/><child link=\"b\"/></joint>"
                                       "</robot>";
    const std::string file = scene("<robot name=\"r\" urdf=\"odd.urdf\"><joint name=\"j\" u=\"2\"/></robot>");
    std::ofstream(path("u.csv")) << csv;
    return run(
        {"simulate", file, "--time", "0.1", "--step", "0.01", "--out", path("t.csv"), "--torques", path("u.csv")});
  }
};

TEST_F(CsvFiles, AreTakenAsSpreadsheetsWriteThem) {
  const double rounding = 1e-12;
  EXPECT_NEAR(speed("t,u:r/j\n0,1\n"), 0.1, rounding);
  EXPECT_NEAR(speed("\xEF\xBB\xBFt,u:r/j\n0,1\n"), 0.1, rounding);
  EXPECT_NEAR(speed("\xEF\xBB\xBF\"t\",\"u:r/j\"\r\n 0, +1 \r\n\r\n"), 0.1, rounding);
  EXPECT_NEAR(speed("note,u:r/j,t,\nx,1,0,\n"), 0.1, rounding);  // t anywhere, columns without a name
  // before the first row the scene's torque acts
  EXPECT_NEAR(speed("t,u:r/j\n10,1\n"), 0.2, rounding);
  EXPECT_NEAR(speed("t,u:r/j\n0.05,1\n"), 0.15, rounding);
}

TEST_F(CsvFiles, AreRefusedByLine) {
  const auto says = [&](const std::string& csv, const std::string& text) {
    const std::string said = refusal(csv);
    EXPECT_EQ(said.find("manycontact: " + path("u.csv") + ":" + text), 0u) << said;
  };
  says("t,t,u:r/j\n0,9,1\n", "1: column 't' occurs twice");
  says("t,u:r/j,u:r/j\n0,9,1\n", "1: column 'u:r/j' occurs twice");
  says("t,\"u:r/j\n0,1\n", "1: cell 2 has a quote that is not closed");
  says("t,u:r/j\n\"0,1\n", "2: cell 1 has a quote that is not closed");
  says("t,\"u:r/j\"x\n0,1\n", "1: cell 2 continues after its closing quote");
  says("t,u:\"r/j\"\n0,1\n", "1: cell 2 has a quote inside");
  says("\xFF\xFEt\n", "1: is UTF-16");
  says("t,u:r/j\n0,1\n0,1\n", "3: the time does not increase");
  says("t,u:r/j\n0,nan\n", "2: column 'u:r/j' has 'nan', expected a finite number");
  says("t,u:r/j\n", "1: has no rows");
  says("t,q:r/j\n0,1\n", "1: has no column of torques");
}

}  // namespace
}  // namespace manycontact::cli
