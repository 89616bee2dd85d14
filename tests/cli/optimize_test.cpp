// optimize is tested: the motion, its JSON, and how it stops.

#include <signal.h>

#include "cli/program.hpp"

namespace manycontact::cli {
namespace {

class Optimize : public Program {
 protected:
  static std::string task(const std::string& name) { return model("tasks/" + name + ".xml"); }
  nlohmann::json json() const { return nlohmann::json::parse(read_text(path("m.json")), nullptr, false); }
  std::vector<std::string> words(const std::string& task_path, std::vector<std::string> more = {}) const {
    std::vector<std::string> out{"optimize", task_path, "--out", path("m.csv"), "--json", path("m.json")};
    out.insert(out.end(), more.begin(), more.end());
    return out;
  }
  /// Writes a task of the models with `from` replaced by `to`; returns its path.
  std::string edited(const std::string& name, const std::string& from, const std::string& to) const {
    std::string text = read_text(task(name));
    for (const auto& [a, b] :
         {std::pair<std::string, std::string>{from, to}, {"scene=\"", "scene=\"" + model("tasks/")}}) {
      const std::size_t at = text.find(a);
      EXPECT_NE(at, std::string::npos) << a;
      text.replace(at, a.size(), b);
    }
    std::ofstream(path("task.xml")) << text;
    return path("task.xml");
  }
};

// `simulate --torques` reads the output of --torques. A plan of simulate's own steps is reproduced, in flight up to
// rounding error; a humanoid on its soles follows its plan for a while without its feedback.
TEST_F(Optimize, TorquesOfAPlanSimulateToThePlan) {
  const auto last_row = [this](const std::string& name) {
    std::istringstream row(lines_of(read_text(path(name))).back());
    std::vector<double> out;
    for (std::string number; std::getline(row, number, ',');) out.push_back(std::stod(number));
    return out;
  };
  std::ofstream(path("diver.urdf"))
      << "<robot name='diver'><link name='body'><inertial><origin xyz='0 0.05 0.1'/><mass value='2'/>"
         "<inertia ixx='0.05' iyy='0.08' izz='0.02' ixy='0' ixz='0.01' iyz='0'/></inertial></link>"
         "<link name='arm'><inertial><origin xyz='0.3 0 0'/><mass value='0.7'/>"
         "<inertia ixx='0.01' iyy='0.03' izz='0.03' ixy='0' ixz='0' iyz='0'/></inertial></link>"
         "<joint name='shoulder' type='revolute'><parent link='body'/><child link='arm'/><origin xyz='0 0.1 0.2'/>"
         "<axis xyz='0 1 0'/><limit effort='9' velocity='100' lower='-9' upper='9'/></joint></robot>";
  std::ofstream(path("scene.xml")) << "<scene><robot name='d' urdf='diver.urdf' base='floating' xyz='0 0 2'>"
                                      "<v>0.3 0 1 0.5 6 -2 1</v></robot></scene>";
  std::ofstream(path("task.xml")) << "<task scene='scene.xml' step='0.01' integrator='symplectic'><phase nodes='30'>"
                                     "<cost name='u' type='control' weight='1e-2'/></phase><terminal>"
                                     "<cost name='x' type='state' weight='1'/></terminal></task>";
  ASSERT_EQ(run(words(path("task.xml"), {"--torques", path("u.csv")})).status, 0);
  const auto simulated = [&](const std::string& scene, const std::string& time, const std::string& step) {
    const Outcome outcome =
        run({"simulate", scene, "--time", time, "--step", step, "--torques", path("u.csv"), "--out", path("s.csv")});
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return last_row("s.csv");
  };
  std::vector<double> plan = last_row("m.csv"), end = simulated(path("scene.xml"), "0.3", "0.01");
  ASSERT_EQ(plan.size(), end.size());
  for (std::size_t k = 0; k < 1 + 8 + 7; ++k) EXPECT_NEAR(end[k], plan[k], 1e-9 * (1 + std::abs(plan[k]))) << k;

  ASSERT_EQ(run(words(task("humanoid_reaches"), {"--torques", path("u.csv")})).status, 0);
  end = simulated(model("tasks/humanoid_scene.xml"), "0.1", "0.001");
  std::istringstream row(lines_of(read_text(path("m.csv")))[6]);  // at 0.1 s
  plan.clear();
  for (std::string number; std::getline(row, number, ',');) plan.push_back(std::stod(number));
  EXPECT_NEAR(plan[0], end[0], 1e-9);
  for (std::size_t k = 1; k < 40; ++k) EXPECT_NEAR(end[k], plan[k], 0.05) << k;
}

TEST_F(Optimize, WritesMotionReportAndSummary) {
  const Outcome outcome = run(words(task("humanoid_reaches")));
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  expect_contains(outcome.out, "humanoid_reaches: fddp converged after");
  expect_contains(outcome.out, "humanoid/left_hand");
  expect_contains(outcome.out, "largest torques");
  expect_contains(outcome.out, "contact forces");
  const nlohmann::json j = json();
  EXPECT_EQ(j["task"], "humanoid_reaches");
  EXPECT_EQ(j["converged"], true);
  EXPECT_EQ(j["reason"], "converged");
  ASSERT_EQ(j["xs"].size(), 41u);
  EXPECT_EQ(j["xs"][0].size(), 39u + 38);
  ASSERT_EQ(j["us"].size(), 40u);
  EXPECT_EQ(j["us"][0].size(), 32u);
  EXPECT_EQ(lines_of(outcome.err).size(), j["iterations"].size() + 1);
  for (const char* key : {"cost", "stop", "regularisation", "step_length", "gaps", "feasible"})
    EXPECT_TRUE(j["iterations"][0].contains(key)) << key;
  EXPECT_EQ(j["iterations"].back()["cost"], j["cost"]);
  EXPECT_EQ(j["report"]["solver"], "fddp");
  EXPECT_LT(j["report"]["kkt_residual"], 1e-6);
  for (const char* key : {"calc", "calc_diff", "direction", "total"}) EXPECT_GT(j["report"]["time_us"][key], 0) << key;

  const std::vector<std::string> rows = lines_of(read_text(path("m.csv")));
  ASSERT_EQ(rows.size(), 42u);
  EXPECT_EQ(rows[0].rfind("t,q:humanoid/root[0],", 0), 0u) << rows[0];
  EXPECT_EQ(rows[41].rfind("0.8,", 0), 0u) << rows[41];
  EXPECT_EQ(std::count(rows[1].begin(), rows[1].end(), ','), 39 + 38 + 3 + 6);
}

TEST_F(Optimize, TasksOfModelsConvergeOnAnyNumberOfThreads) {
  for (const char* name : {"quadruped_trots", "two_humanoids_lift_beam"}) {
    std::string one;
    for (const char* threads : {"1", "2"}) {
      EXPECT_EQ(run(words(task(name), {"--threads", threads})).status, 0) << name;
      EXPECT_LT(json()["report"]["kkt_residual"], 1e-6) << name;
      const std::string csv = read_text(path("m.csv"));
      if (one.empty()) one = csv;
      EXPECT_EQ(csv, one) << name;
    }
  }
}

TEST_F(Optimize, TasksOfModelsWithConstraintsAndInARingConverge) {
  for (const char* name : {"humanoid_points", "ring_squats"}) {
    EXPECT_EQ(run(words(task(name))).status, 0) << name;
    const nlohmann::json report = json()["report"];
    EXPECT_LT(report["kkt_residual"], 1e-6) << name;
    EXPECT_LT(report["constraint_violation"], 1e-8) << name;
    EXPECT_EQ(report["constraints"].size(), name == std::string("ring_squats") ? 0u : 3u);
  }
}

TEST_F(Optimize, FollowsTheMotionInSimulation) {
  const Outcome outcome = run(words(task("humanoid_reaches"), {"--simulate", "1e-3"}));
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  expect_contains(outcome.out, "in simulation contacts drift by");
  const nlohmann::json simulation = json()["report"]["simulation"];
  EXPECT_EQ(simulation["completed"], true);
  EXPECT_LT(simulation["violation_position"], 1e-6);
  EXPECT_LT(simulation["distance"], 0.5);
  EXPECT_EQ(run(words(task("humanoid_reaches"), {"--simulate", "0"})).status, 2);
}

// There are two landings: rows of the CSV and torques of the JSON leave impacts out.
TEST_F(Optimize, TrotsInSimulation) {
  const Outcome outcome = run(words(task("quadruped_trots"), {"--simulate", "1e-3", "--view", path("m.html")}));
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  expect_contains(outcome.out, "54 nodes of 0.01 s and 2 impacts");
  expect_contains(outcome.out, "; impacts dissipate ");
  const nlohmann::json j = json(), simulation = j["report"]["simulation"];
  EXPECT_EQ(simulation["completed"], true);
  EXPECT_LT(simulation["violation_position"], 1e-6);
  EXPECT_LT(simulation["distance"], 1);  // a foot about to land, rad/s
  EXPECT_EQ(j["xs"].size(), 57u);
  EXPECT_EQ(j["us"][24].size(), 0u);
  EXPECT_EQ(j["us"][25].size(), 12u);
  const std::vector<std::string> rows = lines_of(read_text(path("m.csv")));
  ASSERT_EQ(rows.size(), 56u);
  EXPECT_EQ(rows[25].rfind("0.24,", 0), 0u) << rows[25];
  EXPECT_EQ(rows[26].rfind("0.25,", 0), 0u) << rows[26];
}

TEST_F(Optimize, DrawsCharts) {
  if (!has_matplotlib()) GTEST_SKIP() << "there is no matplotlib here";
  EXPECT_EQ(run(words(task("humanoid_points"), {"--charts", path("charts")})).status, 0);
  for (const char* chart : {"convergence", "torques", "forces"}) {
    const std::string svg = read_text(path("charts/" + std::string(chart) + ".svg"));
    expect_contains(svg, "</svg>");
    expect_contains(svg, "humanoid_points");
    EXPECT_EQ(read_text(path("charts/" + std::string(chart) + ".png")).substr(1, 3), "PNG");
  }
  expect_contains(read_text(path("charts/torques.svg")), "left_knee");
  expect_contains(read_text(path("charts/forces.svg")), "smallest cone");
}

TEST_F(Optimize, SaysThatThereIsNoMatplotlib) {
  const Outcome outcome = run_with_python("", words(task("humanoid_points"), {"--charts", path("charts")}));
  EXPECT_EQ(outcome.status, 2);
  expect_contains(outcome.err, "python3 with matplotlib is not installed");
  EXPECT_EQ(lines_of(outcome.err).size(), 1u) << outcome.err;
}

TEST_F(Optimize, SaysWhichConstraintsCannotHold) {
  const std::string wall = R"(<constraint name="behind" type="frame_translation" frame="humanoid/left_hand"
                                 xyz="0 0 0" lower="0.5 -inf -inf" upper="inf inf inf"/>
                                <constraint name="before" type="frame_translation" frame="humanoid/left_hand"
                                 xyz="0 0 0" lower="-inf -inf -inf" upper="0.3 inf inf"/></terminal>)";
  const Outcome outcome = run(words(edited("humanoid_reaches", "</terminal>", wall), {"--threads", "1"}));
  EXPECT_EQ(outcome.status, 1) << outcome.err;
  expect_contains(outcome.out, "did not converge");
  expect_contains(outcome.out, "infeasible constraints: ");
  expect_contains(outcome.out, "behind, by ");
  expect_contains(outcome.out, "outer iterations");
  const auto report = json()["report"];
  double most = 0;
  for (const auto& c : report["constraints"]) most = std::max(most, c["violation"].get<double>());
  EXPECT_EQ(most, report["constraint_violation"]);
  EXPECT_NEAR(most, 0.1, 1e-3);  // half of the distance between the two
  EXPECT_GT(json()["report"]["outer_iterations"], 1);
}

TEST_F(Optimize, EndsAfterTheIterationsAllowed) {
  const Outcome outcome = run(words(edited("humanoid_reaches", "iterations=\"100\"", "iterations=\"2\"")));
  EXPECT_EQ(outcome.status, 1);
  expect_contains(outcome.out, "did not converge after 2 iterations");
  EXPECT_EQ(json()["converged"], false);
  EXPECT_EQ(json()["iterations"].size(), 2u);
}

// After Ctrl-C the current result is written.
TEST_F(Optimize, CanBeInterrupted) {
  const std::string long_one = edited("two_humanoids_lift_beam", "tolerance=\"1e-11\"", "tolerance=\"1e-300\"");
  const std::string err = path("progress.txt");
  const pid_t child = fork();
  if (child == 0) {
    const std::vector<std::string> list = words(long_one);
    std::vector<char*> argv{const_cast<char*>(MANYCONTACT_BINARY)};
    for (const std::string& word : list) argv.push_back(const_cast<char*>(word.c_str()));
    argv.push_back(nullptr);
    if (!freopen("/dev/null", "w", stdout) || !freopen(err.c_str(), "w", stderr)) _exit(126);
    execv(argv[0], argv.data());
    _exit(127);
  }
  while (lines_of(read_text(err)).size() < 2 && waitpid(child, nullptr, WNOHANG) == 0) usleep(1000);
  kill(child, SIGINT);
  int status = 0;
  waitpid(child, &status, 0);
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 1);
  EXPECT_EQ(json()["reason"], "interrupted");
  EXPECT_EQ(lines_of(read_text(path("m.csv"))).size(), 62u);
}

TEST_F(Optimize, SaysWhatIsWrong) {
  const std::string bad = edited("humanoid_reaches", "type=\"state\"", "type=\"stat\"");
  const Outcome outcome = run(words(bad));
  EXPECT_EQ(outcome.status, 2);
  EXPECT_EQ(lines_of(outcome.err).size(), 1u) << outcome.err;
  expect_contains(outcome.err, "manycontact: " + bad + ":5: type of <cost> is 'stat'");
  for (const std::vector<std::string>& wrong :
       {std::vector<std::string>{"optimize", task("humanoid_reaches")},
        {"optimize", "--out", path("m.csv")},
        words(task("humanoid_reaches"), {"--solver", "newton"}),
        words(task("humanoid_reaches"), {"--threads", "0"}),
        words(task("humanoid_reaches"), {"--threads", "4097"}),
        {"optimize", task("humanoid_reaches"), "--out", "-", "--json", "-"},
        {"optimize", task("humanoid_reaches"), "--out", path("no/folder/m.csv")}})
    EXPECT_EQ(run(wrong).status, 2);
}

// The guess of a humanoid on its soles is at rest; in the air, it is not.
TEST_F(Optimize, ReportsAGuessThatIsNotAtRest) {
  std::ofstream(path("scene.xml"))
      << "<scene><robot name='h' urdf='" + model("humanoid.urdf") +
             "' base='floating'/><contact name='left' type='6d' frame='h/left_sole'/></scene>";
  for (const bool stands : {true, false}) {
    std::ofstream(path("task.xml")) << "<task scene='scene.xml' step='0.01'><solver iterations='2'/><phase nodes='2' "
                                       "contacts='"
                                    << (stands ? "left" : "")
                                    << "'><cost name='u' type='control' weight='1e-2'/></phase><terminal>"
                                       "<cost name='x' type='state' weight='1'/></terminal></task>";
    const std::string out = run(words(path("task.xml"))).out;
    EXPECT_EQ(out.find("guess not at rest") == std::string::npos, stands) << out;
    if (!stands)
      expect_contains(
          out,
          "guess not at rest: h/root[2] in phase 1: no torques keep this coordinate at rest in this configuration");
  }
}

}  // namespace
}  // namespace manycontact::cli
