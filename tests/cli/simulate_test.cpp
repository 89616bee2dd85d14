// simulate and stability are tested: trajectories, messages, and how runs stop.

#include <cmath>
#include <map>

#include "cli/program.hpp"

namespace manycontact::cli {
namespace {

// Contains a CSV file without quotes: its columns by name.
struct Csv {
  std::vector<std::string> names;
  std::map<std::string, std::vector<std::string>> columns;
  std::size_t rows = 0;

  explicit Csv(const std::string& path) {
    const auto split = [](const std::string& line) {
      std::vector<std::string> cells;
      std::istringstream stream(line);
      for (std::string cell; std::getline(stream, cell, ',');) cells.push_back(cell);
      if (line.ends_with(",")) cells.push_back("");
      return cells;
    };
    const std::vector<std::string> lines = lines_of(read_text(path));
    if (lines.empty()) return;
    names = split(lines[0]);
    for (std::size_t k = 1; k < lines.size(); ++k, ++rows) {
      const std::vector<std::string> cells = split(lines[k]);
      EXPECT_EQ(cells.size(), names.size()) << path << ":" << k + 1;
      for (std::size_t i = 0; i < std::min(cells.size(), names.size()); ++i) columns[names[i]].push_back(cells[i]);
    }
  }
  double at(const std::string& name, std::size_t row) const { return std::stod(columns.at(name).at(row)); }
  double last(const std::string& name) const { return at(name, rows - 1); }
};

class Simulate : public Program {
 protected:
  std::vector<std::string> words(const std::string& scene, std::vector<std::string> more = {}) const {
    std::vector<std::string> out{"simulate", scene, "--time", "0.1", "--step", "0.001", "--out", path("t.csv")};
    out.insert(out.end(), more.begin(), more.end());
    return out;
  }
  Csv trajectory() const { return Csv(path("t.csv")); }
};

// The motions of all precisions are those of double, up to rounding error.
TEST_F(Simulate, WorksInEachPrecision) {
  const std::string scene = model("quadruped_loop.xml");
  std::map<std::string, double> last;
  for (const std::string precision : {"single", "double", "extended"}) {
    SCOPED_TRACE(precision);
    ASSERT_EQ(run(words(scene, {"--precision", precision})).status, 0);
    const Csv csv = trajectory();
    last[precision] = csv.last(csv.names.at(3));
  }
  EXPECT_NEAR(last["extended"], last["double"], 1e-9);
  EXPECT_NEAR(last["single"], last["double"], 1e-3);
}

// A reference without velocities is followed with the slope of its positions.
TEST_F(Simulate, FollowsTheSlopeOfPositions) {
  std::ofstream(path("pendulum.urdf"))
      << "<robot name='p'><link name='w'/><link name='bob'><inertial><origin xyz='0 0 -0.5'/><mass value='2'/><inertia "
         "ixx='0.1' ixy='0' ixz='0' iyy='0.1' iyz='0' izz='0.01'/></inertial></link><joint name='j' type='continuous'>"
         "<parent link='w'/><child link='bob'/><axis xyz='0 1 0'/></joint></robot>";
  const std::string file = scene("<robot name=\"p\" urdf=\"pendulum.urdf\"/>", "gravity=\"0 0 0\"");
  std::map<std::string, double> end;
  for (const std::string name : {"positions", "both"}) {
    std::ofstream out(path(name + ".csv"));
    out << (name == "both" ? "t,q:p/j,v:p/j\n0,0,1\n2,2,1\n" : "t,q:p/j\n0,0\n0.5,0.5\n2,2\n");
    out.close();
    const Outcome outcome = run({"simulate", file, "--time", "1", "--step", "1e-3", "--pd", "400 40", "--reference",
                                 path(name + ".csv"), "--out", path("t.csv")});
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    end[name] = trajectory().last("q:p/j");
  }
  EXPECT_NEAR(end["both"], 1, 1e-3);
  EXPECT_NEAR(end["positions"], end["both"], 1e-9);
}

// The program reports a contact that closes away from its place; `here` fixes it where it is.
TEST_F(Simulate, TellsWhatClosesAway) {
  const std::string file = scene(
      "<robot name=\"b\" urdf=\"box.urdf\" base=\"floating\"><joint name=\"root\" v=\"1 0 0 0 0 0\"/></robot>"
      "<contact name=\"grip\" type=\"6d\" frame=\"b/crate\" active=\"false\"/>",
      "gravity=\"0 0 0\"");
  for (const std::string what : {"on", "here"}) {
    const Outcome outcome = run(words(file, {"--switch", "0.05 grip " + what, "--json", path("r.json")}));
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    const std::string text = "contact grip closes 0.05 m away from its reference placement";
    EXPECT_EQ(outcome.out.find(text) != std::string::npos, what == "on") << outcome.out;
    EXPECT_EQ(read_text(path("r.json")).find(text) != std::string::npos, what == "on");
  }
}

// On Ctrl-C or kill the existing rows are kept; in a run without an end there is no other way.
TEST_F(Simulate, KeepsWhatIsDoneWhenInterrupted) {
  const std::string file = scene("<robot name=\"b\" urdf=\"box.urdf\" base=\"floating\"/>", "gravity=\"0 0 0\"");
  for (const int signal : {SIGINT, SIGTERM}) {
    const Outcome outcome = run_interrupted({"simulate", file, "--time", "1e6", "--step", "0.001", "--every", "10",
                                             "--out", path("t.csv"), "--json", path("r.json")},
                                            signal);
    EXPECT_EQ(outcome.status, 1) << outcome.err;
    expect_contains(outcome.err, "interrupted");
    EXPECT_GT(trajectory().rows, 1u);
    expect_contains(read_text(path("r.json")), "\"stopped\": \"interrupted\"");
    expect_no_parts();
    std::filesystem::remove(path("t.csv"));
  }
}

TEST_F(Simulate, LinesWithoutEndAreRefused) {
  const std::string file =
      scene("<robot name=\"b\" urdf=\"box.urdf\" base=\"floating\"/><push name=\"p\" frame=\"b/crate\"/>");
  const Outcome outcome = run(words(file, {"--wrenches", "/dev/zero"}));
  EXPECT_EQ(outcome.status, 2);
  expect_contains(outcome.err, "/dev/zero:1: the line is longer than 64 MB");
}

TEST_F(Simulate, WritesTheTrajectory) {
  for (const char* integrator : {"semi-implicit-euler", "rk4"}) {
    const Outcome outcome = run(words(model("humanoid_standing.xml"), {"--integrator", integrator, "--passive"}));
    EXPECT_EQ(outcome.status, 0);
    EXPECT_EQ(outcome.err, "");
    expect_contains(outcome.out, "100 steps of 0.001 s, " + std::string(integrator) + ", to t = 0.1 s");
    expect_contains(outcome.out, "status ok");
    const Csv csv = trajectory();
    EXPECT_EQ(csv.names.size(), 1u + 39 + 38 + 3 + 6);
    EXPECT_EQ(csv.names[0], "t");
    EXPECT_EQ(csv.names[1], "q:humanoid/root[0]");
    EXPECT_EQ(csv.names[40], "v:humanoid/root[0]");
    EXPECT_EQ(csv.names[78], "violation_position");
    EXPECT_EQ(csv.names.back(), "momentum[5]");
    ASSERT_EQ(csv.rows, 101u);
    EXPECT_EQ(csv.at("t", 0), 0);
    EXPECT_NEAR(csv.last("t"), 0.1, 1e-15);
    EXPECT_LT(csv.last("q:humanoid/root[2]"), csv.at("q:humanoid/root[2]", 0) - 0.01);  // it falls
    EXPECT_LT(csv.last("violation_position"), 0.01);
    EXPECT_NEAR(csv.last("energy"), csv.at("energy", 0), 3);
  }
}

// A box of 6.4 kg is pushed up with twice its weight from 0.05 s on; a spring is too stiff for the steps.
TEST_F(Simulate, PushesAndSprings) {
  const std::string box = "<robot name=\"b\" urdf=\"box.urdf\" base=\"floating\"/>";
  const std::string pushed =
      scene(box + "<push name=\"lift\" frame=\"b/crate\" force=\"0 0 62.784\" reference_frame=\"world\"/>");
  EXPECT_EQ(run(words(pushed)).status, 0);
  EXPECT_NEAR(trajectory().last("momentum[2]"), 0, 1e-6);  // its weight, given in the scene
  std::ofstream(path("w.csv")) << "t,w:lift[2]\n0.05,125.568\n";
  const Outcome outcome = run(words(pushed, {"--wrenches", path("w.csv"), "--json", path("s.json")}));
  EXPECT_EQ(outcome.status, 0);
  EXPECT_NEAR(trajectory().last("momentum[2]"), 0.05 * 62.784, 1e-6);
  expect_contains(outcome.out, "work of wrenches");
  EXPECT_GT(nlohmann::json::parse(read_text(path("s.json"))).at("work_of_wrenches"), 1);
  const Outcome solved = run({"solve", pushed, "--derivatives", "--json", path("p.json")});
  EXPECT_EQ(solved.status, 0);
  expect_contains(run({"solve", pushed}).out, "in 1 island, wrenches: 1");
  const auto json = nlohmann::json::parse(read_text(path("p.json")));
  EXPECT_EQ(json.at("wrench_names").at(2), "lift[2]");
  EXPECT_NEAR(json.at("da_dw").at(2).at(2), 1 / 6.4, 1e-12);
  const auto refused = [&](const std::string& file, const std::string& text, const std::string& message) {
    std::ofstream(path("bad.csv")) << text;
    const Outcome bad = run(words(file, {"--wrenches", path("bad.csv")}));
    EXPECT_EQ(bad.status, 2);
    expect_contains(bad.err, message);
  };
  refused(pushed, "t,w:wind[2]\n0,1\n", "bad.csv:1: column 'w:wind[2]' names nothing in the scene");
  refused(pushed, "t,u:x\n0,1\n", "bad.csv:1: has no column of a wrench, expected columns like w:lift[0]");
  refused(scene(box), "t,w:lift[2]\n0,1\n", "the scene has no <wrench>");
  const std::string spring = "<spring name=\"rope\" frame=\"b/crate\" xyz=\"0 0 1\" stiffness=\"";
  const Outcome soft = run(words(scene(box + spring + "100\"/>")));
  expect_lacks(soft.out, "unstable");
  expect_lacks(soft.out, "swings faster");
  const std::string stiff = scene(box + spring + "1e9\"/>");
  const Outcome taken = run(words(stiff));
  EXPECT_EQ(taken.status, 0);
  expect_contains(taken.out, "spring rope oscillates faster at the start than steps of 0.001 s can follow");
  expect_contains(run(words(stiff, {"--integrator", "rk4"})).out, "spring rope is unstable with rk4 in steps above");
}

// Free fall is exact: z by semi-implicit Euler is -g h^2 k (k + 1) / 2, by RK4 -g t^2 / 2.
TEST_F(Simulate, FreeFall) {
  const std::string falling = scene("<robot name=\"b\" urdf=\"box.urdf\" base=\"floating\"/>");
  EXPECT_EQ(run(words(falling)).status, 0);
  EXPECT_NEAR(trajectory().last("q:b/root[2]"), -9.81 * 1e-6 * 100 * 101 / 2, 1e-14);
  EXPECT_EQ(run(words(falling, {"--integrator", "rk4"})).status, 0);
  const Csv csv = trajectory();
  EXPECT_NEAR(csv.last("q:b/root[2]"), -9.81 * 0.005, 1e-14);
  EXPECT_NEAR(csv.last("v:b/root[2]"), -0.981, 1e-14);
  EXPECT_NEAR(csv.last("momentum[2]"), -6.4 * 0.981, 1e-3);
  EXPECT_EQ(csv.last("violation_position"), 0);
}

TEST_F(Simulate, EveryNthAndTheLast) {
  EXPECT_EQ(run(words(model("arm_pushes_box.xml"), {"--every", "30"})).status, 0);
  const Csv csv = trajectory();
  ASSERT_EQ(csv.rows, 5u);
  EXPECT_NEAR(csv.at("t", 3), 0.09, 1e-15);
  EXPECT_NEAR(csv.at("t", 4), 0.1, 1e-15);
}

TEST_F(Simulate, GainsHoldTheContacts) {
  const auto drift = [&](const std::string& gains) {
    EXPECT_EQ(run(words(model("humanoid_standing.xml"), {"--passive", "--gains", gains})).status, 0);
    return trajectory().last("violation_position");
  };
  const double none = drift("0 0");
  EXPECT_LT(drift("400 40"), 0.9 * none);
  EXPECT_EQ(drift(" 400, 40 "), drift("400 40"));
  EXPECT_LT(drift("400,40"), 0.9 * none);
  EXPECT_LT(drift("recommended"), 0.1 * none);
}

// The bytes are the same on standard output, which then contains nothing else.
TEST_F(Simulate, TheSameBytesTwice) {
  std::vector<std::string> out = words(model("quadruped_loop.xml"));
  out.back() = "-";
  const Outcome outcome = run(out);
  EXPECT_EQ(outcome.status, 0);
  EXPECT_EQ(run(words(model("quadruped_loop.xml"))).status, 0);
  EXPECT_EQ(outcome.out, read_text(path("t.csv")));
  EXPECT_EQ(trajectory().rows, 101u);
}

TEST_F(Simulate, DivergenceStopsAndSaysSo) {
  const std::string scene = model("humanoid_hands_and_feet.xml");
  for (const char* integrator : {"semi-implicit-euler", "rk4"}) {
    const Outcome outcome = run(words(scene, {"--gains", "1e8 2e4", "--integrator", integrator}));
    EXPECT_EQ(outcome.status, 1);
    ASSERT_EQ(lines_of(outcome.err).size(), 1u) << outcome.err;
    EXPECT_TRUE(outcome.err.starts_with("manycontact: " + scene + ": stopped in step ")) << outcome.err;
    expect_contains(outcome.out, "unstable with " + std::string(integrator) + " in steps above");
    const Csv csv = trajectory();
    EXPECT_GE(csv.rows, 2u);
    EXPECT_LT(csv.rows, 101u);
    for (const auto& [name, column] : csv.columns) EXPECT_TRUE(std::isfinite(csv.last(name))) << name;
    const std::string rows = std::to_string(csv.rows);  // one row per state: the start and the completed steps
    expect_contains(outcome.err, "step " + rows + " of 100");
  }
}

// The first step of a robot without mass fails; the start is written.
TEST_F(Simulate, SolverFailureStops) {
  const std::string massless =
      "<robot name=\"b\" urdf=\"empty.urdf\" base=\"floating\"/><robot name=\"a\" urdf=\"arm.urdf\" base=\"fixed\"/>";
  std::ofstream(path("empty.urdf")) << "<robot name=\"empty\"><link name=\"nothing\"/></robot>";
  const Outcome outcome = run(words(scene(massless)));
  EXPECT_EQ(outcome.status, 1);
  expect_contains(outcome.err, "stopped in step 1 of 100, at t = 0 s: the solver failed: ");
  EXPECT_EQ(trajectory().rows, 1u);
}

TEST_F(Simulate, ProgressOnlyWhenAsked) {
  const std::vector<std::string> long_run{"simulate",     model("two_humanoids_carry_beam.xml"),
                                          "--time",       "1",
                                          "--step",       "2e-4",
                                          "--integrator", "rk4",
                                          "--every",      "1000",
                                          "--out",        path("t.csv")};
  EXPECT_EQ(run(long_run).err, "");
  std::vector<std::string> shown = long_run;
  shown.push_back("--progress");
  expect_contains(run(shown).err, "% ");
}

TEST_F(Simulate, BadUsage) {
  const std::string scene = model("humanoid_standing.xml"), out = path("t.csv");
  const std::vector<std::pair<std::vector<std::string>, std::string>> cases = {
      {{"simulate"}, "SCENE is missing"},
      {{"simulate", scene, "--step", "1", "--out", out}, "option --time is missing"},
      {{"simulate", scene, "--time", "1", "--out", out}, "option --step is missing"},
      {{"simulate", scene, "--time", "1", "--step", "1"}, "option --out is missing"},
      {{"simulate", scene, "--time", "0", "--step", "1", "--out", out},
       "option --time is '0', expected a number above 0"},
      {{"simulate", scene, "--time", "1s", "--step", "1", "--out", out}, "option --time is '1s'"},
      {{"simulate", scene, "--time", "inf", "--step", "1", "--out", out}, "option --time is 'inf'"},
      {{"simulate", scene, "--time", "1", "--step", "-1", "--out", out}, "option --step is '-1'"},
      {{"simulate", scene, "--time", "1", "--step", "1e-12", "--out", out}, "--time is more than 1e9 times --step"},
      {words(scene, {"--json", out}), "--out and --json are the same file"},
      {{"simulate", scene, "--time", "1", "--step", "1", "--out", "-", "--json", "-"},
       "--out and --json are both standard output"},
      {words(scene, {"--forces", path("./t.csv")}), "--out and --forces are the same file"},
      {{"simulate", scene, "--time", "1", "--step", "1", "--out", scene}, "--out would overwrite"},
      {words(scene, {"--integrator", "euler"}), "unknown integrator 'euler', expected semi-implicit-euler or rk4"},
      {words(scene, {"--gains", "1"}), "option --gains is '1', expected 'alpha beta'"},
      {words(scene, {"--gains", "1 2 3"}), "option --gains is '1 2 3'"},
      {words(scene, {"--gains", "-1 2"}), "option --gains is '-1 2'"},
      {words(scene, {"--gains", "1 nan"}), "option --gains is '1 nan'"},
      {words(scene, {"--damping", "0"}), "option --damping is '0', expected a number above 0"},
      {words(scene, {"--every", "0"}), "option --every is '0'"},
      {words(scene, {"--method", "magic"}), "unknown method 'magic'"},
      {{"stability", scene}, "option --out is missing"},
      {{"stability", scene, "--out", out, "--steps", "0"}, "option --steps is '0'"},
  };
  for (const auto& [command, message] : cases) {
    const Outcome outcome = run(command);
    EXPECT_EQ(outcome.status, 2) << message;
    EXPECT_EQ(outcome.out, "") << message;
    const std::vector<std::string> lines = lines_of(outcome.err);
    ASSERT_EQ(lines.size(), 2u) << outcome.err;
    EXPECT_NE(lines[0].find(message), std::string::npos) << lines[0];
    EXPECT_TRUE(lines[1].starts_with("usage: manycontact " + command[0] + " SCENE ")) << lines[1];
    EXPECT_FALSE(std::filesystem::exists(out));
  }
}

TEST_F(Simulate, OutputThatCannotBeWrittenIsSaid) {
  const std::string scene = model("humanoid_standing.xml");
  const Outcome outcome = run({"simulate", scene, "--time", "1", "--step", "1", "--out", "/nowhere/t.csv"});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_TRUE(outcome.err.starts_with("manycontact: /nowhere/t.csv:1: cannot be written")) << outcome.err;
  EXPECT_EQ(lines_of(outcome.err).size(), 1u);
}

// In short runs of the charts every curve exists; stiff gains are lost beyond their predicted limit and not below.
TEST_F(Simulate, StabilityMeasuresAndDraws) {
  const std::string out = path("charts");
  const Outcome outcome = run({"stability", model("humanoid_standing.xml"), "--out", out, "--steps", "50"});
  const Csv drift(out + "/drift.csv"), energy(out + "/energy.csv");
  ASSERT_GT(drift.rows, 200u);
  int stable = 0, lost = 0;
  for (std::size_t k = 0; k < drift.rows; ++k) {
    if (drift.columns.at("gains")[k] == "recommended" || drift.at("alpha", k) != 1e6) continue;
    const double h = drift.at("step_s", k), limit = drift.at("largest_stable_step_s", k);
    const bool good = drift.columns.at("stopped")[k].empty() && drift.at("largest_violation_position", k) < 0.01;
    if (h < limit) {
      EXPECT_TRUE(good) << h;
    }
    if (h > 1.1 * limit && h < 0.03) {
      EXPECT_FALSE(good) << h;
    }
    ++(good ? stable : lost);
  }
  EXPECT_GE(stable, 5);
  EXPECT_GE(lost, 20);
  EXPECT_EQ(energy.last("step"), 50);
  EXPECT_LT(energy.last("largest_energy_error_J"), 1e-6);

  if (!has_matplotlib()) {
    EXPECT_EQ(outcome.status, 1);
    expect_contains(outcome.err, "matplotlib is not installed");
    return;
  }
  EXPECT_EQ(outcome.status, 0);
  EXPECT_EQ(outcome.err, "");
  for (const char* name : {"drift", "energy"}) {
    EXPECT_TRUE(read_text(out + "/" + name + ".png").starts_with("\x89PNG")) << name;
    EXPECT_NE(read_text(out + "/" + name + ".svg").find("</svg>"), std::string::npos) << name;
  }
}

// Without Python there are the CSV files, one line that reports it, and status 1.
TEST_F(Simulate, StabilityWithoutPython) {
  const Outcome outcome = run_with_python(
      "", {"stability", model("arm_pushes_box.xml"), "--out", path("c"), "--steps", "10", "--time", "0.01"});
  EXPECT_EQ(outcome.status, 1);
  EXPECT_EQ(lines_of(outcome.err).size(), 1u) << outcome.err;
  expect_contains(outcome.err, "python3 with matplotlib is not installed");
  EXPECT_TRUE(std::filesystem::exists(path("c") + "/drift.csv"));
  EXPECT_TRUE(std::filesystem::exists(path("c") + "/energy.csv"));
  EXPECT_TRUE(std::filesystem::exists(path("c") + "/stability.json"));
}

// With one step, or a scene in which nothing moves, the program ends and reports what is empty.
TEST_F(Simulate, StabilityOfLittle) {
  if (!has_matplotlib()) GTEST_SKIP() << "there is no matplotlib here";
  const Outcome one =
      run({"stability", model("arm_pushes_box.xml"), "--out", path("one"), "--steps", "1", "--time", "0.01"});
  EXPECT_EQ(one.status, 0) << one.err;
  EXPECT_EQ(Csv(path("one") + "/energy.csv").last("step"), 1);
  const std::string still = scene(
      "<robot name=\"b\" urdf=\"box.urdf\" base=\"floating\"/><contact name=\"c\" type=\"6d\" frame=\"b/crate\"/>",
      "gravity=\"0 0 0\"");
  const Outcome none = run({"stability", still, "--out", path("none"), "--steps", "20", "--time", "0.01"});
  EXPECT_EQ(none.status, 0) << none.err;
  expect_contains(none.out, "there is no energy chart, because no run that took a step has an energy error");
  EXPECT_TRUE(std::filesystem::exists(path("none") + "/drift.svg"));
  EXPECT_FALSE(std::filesystem::exists(path("none") + "/energy.svg"));
}

TEST_F(Simulate, StabilityNeedsContacts) {
  const std::string free = scene("<robot name=\"b\" urdf=\"box.urdf\" base=\"floating\"/>");
  const Outcome outcome = run({"stability", free, "--out", path("c")});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_EQ(outcome.err, "manycontact: " + free + ":1: the scene has no contacts, expected at least one contact\n");
}

}  // namespace
}  // namespace manycontact::cli
