// solve, inspect and simulate warn of contacts out of place, or that pull, slip or tip; limits; masses; energy.

#include <cmath>

#include "cli/program.hpp"

namespace manycontact::cli {
namespace {

using nlohmann::json;

class FindingsOfTheProgram : public Program {
 protected:
  json simulate(const std::string& scene, std::vector<std::string> more, int status = 0) const {
    std::vector<std::string> words{"simulate", scene,   "--time",      "0.1",    "--step",
                                   "0.001",    "--out", path("t.csv"), "--json", path("s.json")};
    words.insert(words.end(), more.begin(), more.end());
    const Outcome outcome = run(words);
    EXPECT_EQ(outcome.status, status) << outcome.err;
    said_ = outcome.out;
    return json::parse(read_text(path("s.json")), nullptr, false);
  }
  mutable std::string said_;
};

const std::string kBox = R"(<robot name="b" urdf="box.urdf" base="floating"/>)";

TEST_F(FindingsOfTheProgram, AFootFarAway) {
  const std::string far = scene(kBox + R"(<contact name="foot" type="3d" frame="b/crate" xyz="0 3 4"/>)");
  const json j = solve({far});
  EXPECT_EQ(j.at("report").at("status"), "ok");
  ASSERT_EQ(j.at("placement_errors").size(), 1u);
  EXPECT_EQ(j.at("placement_errors")[0].at("contact"), "foot");
  EXPECT_NEAR(j.at("placement_errors")[0].at("position").get<double>(), 5, 1e-12);
  const std::string text = "out of place: foot by 5 m; the error is not corrected, because alpha is 0";
  expect_contains(run({"solve", far}).out, text);
  expect_contains(run({"inspect", far}).out, text);
  EXPECT_EQ(simulate(far, {}).at("placement_errors").size(), 1u);
  expect_contains(said_, text);
  for (const char* name : {"humanoid_standing.xml", "herd.xml"})
    EXPECT_EQ(solve({model(name)}).at("placement_errors").size(), 0u) << name;
}

// A weld falls at 1 m/s: all commands report it, and it continues unless a switch stops it.
TEST_F(FindingsOfTheProgram, AContactThatMoves) {
  const std::string inside = R"(<robot name="b" urdf="box.urdf" base="floating"><v>0 0 -1 0 0 0</v></robot>
    <contact name="weld" type="6d" frame="b/crate"/>)";
  const std::string falls = scene(inside);
  const json j = solve({falls});
  ASSERT_EQ(j.at("velocity_errors").size(), 1u);
  EXPECT_EQ(j.at("velocity_errors")[0].at("contact"), "weld");
  EXPECT_NEAR(j.at("velocity_errors")[0].at("linear").get<double>(), 1, 1e-12);
  EXPECT_EQ(j.at("findings")[0].at("kind"), "velocity");
  const std::string text =
      "moves although constrained: weld by 1 m/s; the velocity is not corrected, because beta is 0";
  expect_contains(run({"solve", falls}).out, text);
  expect_contains(run({"inspect", falls}).out, text);
  EXPECT_EQ(simulate(falls, {}).at("velocity_errors").size(), 1u);
  expect_contains(said_, text);
  const auto height = [&] {
    const std::string last = lines_of(read_text(path("t.csv"))).back();
    std::istringstream cells(last);
    std::string cell;
    for (int k = 0; k < 4; ++k) std::getline(cells, cell, ',');
    return std::stod(cell);
  };
  EXPECT_NEAR(height(), -0.1, 1e-9);  // it falls
  const json held = simulate(falls, {"--switch", "0 weld on"});
  EXPECT_NEAR(height(), 0, 1e-12);
  EXPECT_NEAR(held.at("work_of_torques").get<double>(), -0.5 * 6.4, 1e-9);
  expect_contains(said_, "at t = 0 s weld (on before) closed: the impact dissipated 3.2 J");
  (void)simulate(scene(inside, "consistent=\"true\""), {});
  EXPECT_NEAR(height(), 0, 1e-12);
  expect_contains(said_,
                  "consistent: test (scene.xml:1): q and v were made consistent with the contacts; v changed most at "
                  "b/root[2], by 1");
  for (const char* name : {"humanoid_standing.xml", "herd.xml"})
    EXPECT_EQ(solve({model(name)}).at("velocity_errors").size(), 0u) << name;
}

// Only the shares of a weight on two balls are not unique: the output marks each such force.
TEST_F(FindingsOfTheProgram, ForcesThatAreNotUnique) {
  const std::string door = scene(kBox + R"(<contact name="lower" type="3d" frame="b/crate" offset="-0.2 0 -0.2"/>
    <contact name="upper" type="3d" frame="b/crate" offset="-0.2 0 0.2"/>)");
  EXPECT_EQ(solve({door}).at("forces_unique"), (json{true, true, false, true, true, false}));
  const std::string told = run({"solve", door}).out;
  expect_contains(told, "forces that are not unique (*) have least norm");
  expect_contains(told, "upper 3d local -31.39 0.00 31.39*");
  expect_contains(told, "a newton metre weighted as a newton");
  const std::string alone = scene(kBox + R"(<contact name="one" type="6d" frame="b/crate"/>)");
  EXPECT_EQ(solve({alone}).at("forces_unique"), json(std::vector<bool>(6, true)));
  expect_lacks(run({"solve", alone}).out, "*");
}

// A barely independent row and one barely dependent are both listed by name, with their effect.
TEST_F(FindingsOfTheProgram, RowsThatNearlyDepend) {
  const std::string near = scene(kBox + R"(<contact name="one" type="3d" frame="b/crate" offset="0.3 0 0"/>
    <contact name="two" type="1d" axis="1 0 0" frame="b/crate" offset="0.3 5e-11 0"/>
    <contact name="three" type="1d" axis="1 0 0" frame="b/crate" offset="0.3 0 5e-12"/>)");
  const json j = solve({near}, 1);  // rounding may change the forces by their own size
  EXPECT_EQ(j.at("report").at("status"), "regularised");
  EXPECT_NEAR(j.at("report").at("rank_gap").get<double>(), 10, 0.1);
  ASSERT_EQ(j.at("near_dependent").size(), 1u);
  EXPECT_EQ(j.at("near_dependent")[0].at("rows"), json{"two[0]"});
  EXPECT_GT(j.at("near_dependent")[0].at("times_loads").get<double>(), 1e6);
  for (const char* command : {"solve", "inspect"}) {
    const std::string told = run({command, near}).out;
    if (command == std::string("solve")) expect_contains(told, "rounding errors may be larger than the solution");
    expect_contains(told, "nearly dependent: two[0]: only 4.8e-11 of the row is independent of the other rows");
    expect_contains(told, "row two[0] is accepted, although only 4.8e-11 of its norm is orthogonal to the rows");
    expect_contains(told, "row three[0] is rejected with");
  }
  EXPECT_EQ(solve({model("humanoid_standing.xml")}).at("near_dependent").size(), 0u);
}

// For a stretched leg no derivatives exist, and the program reports it.
TEST_F(FindingsOfTheProgram, SingularPostures) {
  const std::string stretched = scene(R"(<robot name="q" urdf="quadruped.urdf" base="floating"/>
    <contact name="trunk" type="6d" frame="q/trunk"/><contact name="foot" type="3d" frame="q/RF_foot"/>)");
  const json j = solve({stretched, "--derivatives"});
  ASSERT_EQ(j.at("rank_changes").size(), 1u);
  EXPECT_TRUE(j.at("rank_changes")[0].at("singular").get<bool>());
  EXPECT_EQ(j.at("rank_changes")[0].at("contacts"), (json{"trunk", "foot"}));
  const std::string told = run({"solve", stretched, "--derivatives"}).out;
  expect_contains(told,
                  "rank changes: the rank of the rows of trunk, foot is 8 of 9 at this configuration, and larger at");
  expect_contains(told,
                  "derivatives assume that the rank is constant, but the rank of the rows of trunk, foot is 8 of 9");
  expect_contains(run({"inspect", stretched}).out, "the configuration is singular");
}

// A box hangs on a contact that can only push, and is drawn along one with friction alone.
TEST_F(FindingsOfTheProgram, PullsAndSlips) {
  const std::string hangs = scene(kBox + R"(<contact name="top" type="3d" frame="b/crate" mu="0.5"/>)");
  const double weight = 6.4 * 9.81;
  json j = solve({hangs});
  EXPECT_EQ(j.at("violations").size(), 0u);  // the world supports it
  const std::string below =
      scene(kBox + R"(<contact name="top" type="3d" frame="b/crate" mu="0.5"/>)", "gravity=\"9.81 0 9.81\"");
  j = solve({below});
  ASSERT_EQ(j.at("violations").size(), 1u);
  EXPECT_EQ(j.at("violations")[0].at("kind"), "pulls");
  EXPECT_NEAR(j.at("violations")[0].at("by").get<double>(), weight, 0.01 * weight);
  expect_contains(run({"solve", below}).out, "pulls: top by 62.8 N");
  expect_contains(run({"inspect", below}).out, "pulls: top by 62.8 N");
  const std::string aslant =
      scene(kBox + R"(<contact name="top" type="3d" frame="b/crate" mu="0.5"/>)", "gravity=\"9.81 0 -9.81\"");
  j = solve({aslant});
  ASSERT_EQ(j.at("violations").size(), 1u);
  EXPECT_EQ(j.at("violations")[0].at("kind"), "slips");
  EXPECT_NEAR(j.at("violations")[0].at("needs_mu").get<double>(), 1, 1e-9);
  expect_contains(run({"solve", aslant}).out, "slips: top by 31.4 N more than mu 0.5 allows; mu 1 would be sufficient");
}

// Tilted feet of bent legs are balanced on the ground, with forces in any axes, but not on a wall.
TEST_F(FindingsOfTheProgram, TiltedFeetStand) {
  const auto stands = [&](const std::string& more) {
    std::string text = R"(<robot name="q" urdf="quadruped.urdf" base="floating" xyz="0 0 0.3824" u="gravity">)", feet;
    for (const std::string leg : {"LF", "RF", "LH", "RH"}) {
      text += "<joint name=\"" + leg + "_hip\" q=\"0.7\"/><joint name=\"" + leg + "_knee\" q=\"-1.4\"/>";
      feet += "<contact name=\"" + leg + "\" type=\"3d\" frame=\"q/" + leg + "_foot\" mu=\"0.6\" " + more + "/>";
    }
    return scene(text + "</robot>" + feet);
  };
  for (const char* frame : {"local", "world"}) {
    const std::string axes = "reference_frame=\"" + std::string(frame) + "\"";
    EXPECT_EQ(solve({stands(axes)}).at("violations").size(), 0u) << frame;
    EXPECT_EQ(simulate(stands(axes), {}).at("violations").size(), 0u) << frame;
    const json wall = solve({stands(axes + " normal=\"1 0 0\"")}).at("violations");
    EXPECT_EQ(wall.size(), 4u) << frame;
  }
}

// A humanoid at rest does not tip; it tips when it collapses without torques, and the first time is reported.
TEST_F(FindingsOfTheProgram, TheFirstTime) {
  std::string text = read_text(model("humanoid_standing.xml"));
  const std::string sole = "mu=\"0.7\" box=\"0.02 0.02\" ";
  for (std::size_t at = 0; (at = text.find("type=\"6d\"", at)) != std::string::npos; at += sole.size() + 1)
    text.insert(at, sole);
  scene("");  // copies the robots
  std::ofstream(path("stands.xml")) << text;
  EXPECT_EQ(solve({path("stands.xml")}).at("violations").size(), 0u);
  std::vector<std::string> words{"simulate", path("stands.xml"), "--time", "0.4",          "--step",   "0.001",
                                 "--out",    path("t.csv"),      "--json", path("s.json"), "--passive"};
  const Outcome outcome = run(words);
  const json run_json = json::parse(read_text(path("s.json")), nullptr, false);
  ASSERT_GE(run_json.at("violations").size(), 1u);
  double before = 0;
  for (const json& v : run_json.at("violations")) {
    EXPECT_GE(v.at("first_time").get<double>(), before);
    before = v.at("first_time");
    EXPECT_GT(v.at("by").get<double>(), 0);
  }
  EXPECT_LT(before, 0.4);
  expect_contains(outcome.out, "from t = ");
}

// Copies share a line, which shows the worst of them.
TEST_F(FindingsOfTheProgram, CopiesAreOneLine) {
  const std::string herd = scene(R"(<robot name="q" urdf="quadruped.urdf" base="floating" xyz="0 0 0.5" copies="9">
      <joint name="LF_knee" q="0.3"/></robot>
    <contact name="LF" type="3d" frame="q/LF_foot" mu="0.1"/> <contact name="RH" type="3d" frame="q/RH_foot" mu="0.1"/>)");
  const Outcome outcome = run({"simulate", herd, "--time", "0.3", "--step", "0.001", "--out", path("t.csv"), "--json",
                               path("s.json"), "--passive", "--gains", "recommended"});
  const json told = json::parse(read_text(path("s.json")), nullptr, false);
  ASSERT_GE(told.at("violations").size(), 9u);
  std::size_t lines = 0;
  for (const std::string& line : lines_of(outcome.out)) lines += line.starts_with("  from t = ");
  EXPECT_GE(lines, 1u);
  EXPECT_LE(lines, 16u);
  expect_contains(outcome.out, "s on, LF0 .. LF8; at most: LF");
  for (const std::string& line : lines_of(outcome.out)) EXPECT_LE(line.size(), 100u);
}

TEST_F(FindingsOfTheProgram, LimitsAndJoints) {
  const std::string beyond = scene(R"(<robot name="q" urdf="quadruped.urdf" base="floating">
    <joint name="LF_knee" q="3" u="200"/></robot>)");
  const json j = solve({beyond});
  ASSERT_EQ(j.at("limits_passed").size(), 2u);
  EXPECT_EQ(j.at("limits_passed")[0].at("joint"), "q/LF_knee");
  EXPECT_EQ(j.at("limits_passed")[0].at("quantity"), "position");
  EXPECT_EQ(j.at("limits_passed")[1].at("quantity"), "effort");
  expect_contains(run({"solve", beyond}).out, "q/LF_knee: effort 200, limit ");
  const std::string out = run({"inspect", beyond}).out;
  expect_contains(out, "Joints: limits of the robots' files");
  expect_contains(out, "q/LF_knee: position 3, limit ");
  EXPECT_EQ(simulate(beyond, {}).at("limits_passed").at(0).at("first_time"), 0);
}

TEST_F(FindingsOfTheProgram, ContradictionsAndMasslessJoints) {
  const std::string torn = scene(R"(<robot name="b" urdf="box.urdf" base="floating"><v>0 0 1 0 0 0</v></robot>
    <contact name="one" type="3d" frame="b/crate"/> <contact name="two" type="3d" frame="b/crate" gains="0 10"/>)");
  const json j = solve({torn});
  EXPECT_EQ(j.at("report").at("status"), "inconsistent");
  ASSERT_EQ(j.at("contradictions").size(), 2u);
  EXPECT_NEAR(j.at("contradictions")[0].at("linear").get<double>(), 5, 1e-9);
  const std::string told = run({"solve", torn}).out;
  expect_contains(told, "contradicted: one, two; most of all one by 5 m/s^2");
  expect_lacks(told, "rounding");

  std::ofstream(path("ghost.urdf")) << R"(<robot name="ghost"><link name="base"/><link name="nothing"/>
    <joint name="wrist" type="continuous"><parent link="base"/><child link="nothing"/></joint></robot>)";
  const std::string ghost = scene(R"(<robot name="g" urdf="ghost.urdf" base="fixed"/>)");
  EXPECT_EQ(solve({ghost}, 1).at("massless_joints"), json{"g/wrist"});
  expect_contains(run({"solve", ghost}).out, "joints without inertia: g/wrist: there is no mass below the joint");
}

TEST_F(FindingsOfTheProgram, LargeIslandsAreNotSolvedDenselyUnasked) {
  const std::string many = scene(R"(<robot name="q" urdf="quadruped.urdf" base="floating" copies="60"/>
    <contact name="c" type="3d" frame="q/trunk" to="q+1/trunk"/>)");
  const std::string out = run({"solve", many}).out;
  expect_contains(out, "not compared, because one dense solve would take");
  expect_contains(out, "--compare compares in any case");
  expect_lacks(run({"solve", model("herd.xml")}).out, "not compared");
}

// A box falls onto a point, with RK4 so that the impact is the switch's own.
TEST_F(FindingsOfTheProgram, ContactsCloseWithAnImpact) {
  const std::string falls = scene(kBox + R"(<contact name="c" type="3d" frame="b/crate" active="false"/>)");
  const json j = simulate(falls, {"--switch", "0.05 c here", "--integrator", "rk4", "--forces", path("f.csv")});
  const double v = 9.81 * 0.05, lost = 0.5 * 6.4 * v * v;
  EXPECT_NEAR(j.at("work_of_torques").get<double>(), -lost, 0.01 * lost);
  EXPECT_NEAR(j.at("energy")[1].get<double>() - j.at("energy")[0].get<double>(), -lost, 0.01 * lost);
  expect_contains(said_, "at t = 0.05 s c closed: the impact dissipated ");
  const std::vector<std::string> forces = lines_of(read_text(path("f.csv")));
  ASSERT_EQ(forces.size(), 102u);
  EXPECT_EQ(forces[0], "t,f:c[0],f:c[1],f:c[2]");
  EXPECT_EQ(forces[1], "0,0,0,0");
  EXPECT_NEAR(std::stod(forces.back().substr(forces.back().rfind(',') + 1)), 6.4 * 9.81, 1e-6);
  for (const char* bad : {"0.05 c", "c on", "0.05 c up", "-1 c on"})
    EXPECT_EQ(run({"simulate", falls, "--time", "1", "--step", "1", "--out", path("x.csv"), "--switch", bad}).status,
              2);
  expect_contains(
      run({"simulate", falls, "--time", "1", "--step", "1", "--out", path("x.csv"), "--switch", "0 d on"}).err,
      "there is no contact 'd'");
}

// A switch at or after the end has no effect: the summary, or else standard error, names it.
TEST_F(FindingsOfTheProgram, SwitchesThatAreNotReached) {
  const std::string falls = scene(kBox + R"(<contact name="c" type="3d" frame="b/crate" active="false"/>)");
  const auto switched = [&](const std::string& list, const std::string& out) {
    return run({"simulate", falls, "--time", "0.01", "--step", "0.001", "--out", out, "--switch", list});
  };
  const std::string late = "contacts were not switched, because the run ended at t = 0.01 s: 0.01 c off, 5 c here";
  const Outcome told = switched("5 c here, 0.002 c here, 0.01 c off", path("t.csv"));
  EXPECT_EQ(told.status, 0);
  EXPECT_EQ(told.err, "");
  expect_contains(told.out, late);
  expect_contains(told.out, "at t = 0.002 s c closed");
  const Outcome alone = switched("5 c here, 0.002 c here, 0.01 c off", "-");
  EXPECT_EQ(alone.status, 0);
  EXPECT_EQ(alone.err, "manycontact: " + falls + ": " + late + "\n");
  EXPECT_EQ(alone.out, read_text(path("t.csv")));
  expect_lacks(switched("0.002 c here", path("t.csv")).out, "not switched");
  expect_lacks(switched("0.002 c here, 0.002 c off", path("t.csv")).out, "closed");
}

// The PD law keeps a configuration that no torque would; torques from a file act from their time on.
TEST_F(FindingsOfTheProgram, TorquesAndReferences) {
  const std::string arm = scene(R"(<robot name="a" urdf="arm.urdf" base="fixed" armature="0.1"/>)");
  const auto moved = [&](std::vector<std::string> more) {
    (void)simulate(arm, std::move(more));
    const std::vector<std::string> rows = lines_of(read_text(path("t.csv")));
    std::istringstream last(rows.back());
    double largest = 0;
    std::string cell;
    std::getline(last, cell, ',');
    for (int k = 0; k < 7; ++k) std::getline(last, cell, ','), largest = std::max(largest, std::abs(std::stod(cell)));
    return largest;
  };
  const std::string joint = solve({arm}).at("velocity_names")[0];
  std::ofstream(path("u.csv")) << "t,u:" << joint << "\n0,0\n0.05,1\n";
  const double free = moved({});
  const double pushed = moved({"--torques", path("u.csv")});
  EXPECT_GT(pushed, free + 1e-4);
  std::ofstream(path("r.csv")) << "t,q:" << joint << ",v:" << joint << "\n0,0,2\n0.1,0.2,2\n";
  EXPECT_NEAR(moved({"--pd", "4000 200", "--reference", path("r.csv"), "--integrator", "rk4"}), 0.2, 0.05);
  const auto refused = [&](const std::string& text, const std::string& message) {
    std::ofstream(path("bad.csv")) << text;
    const Outcome outcome =
        run({"simulate", arm, "--time", "1", "--step", "1", "--out", path("x.csv"), "--torques", path("bad.csv")});
    EXPECT_EQ(outcome.status, 2);
    EXPECT_EQ(lines_of(outcome.err).size(), 1u) << outcome.err;
    expect_contains(outcome.err, message);
  };
  refused("", "bad.csv:1: ");
  refused("time\n", "bad.csv:1: there is no column 't', expected");
  refused("t,u:a/none\n0,0\n", "bad.csv:1: column 'u:a/none' names nothing in the scene");
  refused("t,u:" + joint + "\n0,x\n", "bad.csv:2: column 'u:" + joint + "' has 'x', expected a finite number");
  refused("t,u:" + joint + "\n0\n", "bad.csv:2: the row has 1 cells, expected 2");
  refused("t,u:" + joint + "\n1,0\n1,0\n", "bad.csv:3: the time does not increase");
}

constexpr char kCart[] =
    "<robot name='cart'><link name='rail'/><link name='cart'><inertial><mass value='1'/><inertia ixx='1' ixy='0' "
    "ixz='0' iyy='1' iyz='0' izz='1'/></inertial></link><link name='rod'><inertial><origin xyz='0 0 0.5'/>"
    "<mass value='1'/><inertia ixx='0.01' ixy='0' ixz='0' iyy='0.01' iyz='0' izz='0.01'/></inertial></link>"
    "<joint name='x' type='prismatic'><parent link='rail'/><child link='cart'/><axis xyz='1 0 0'/>"
    "<limit lower='-9' upper='9' velocity='99' effort='99'/></joint>"
    "<joint name='pole' type='continuous'><parent link='cart'/><child link='rod'/><axis xyz='0 1 0'/></joint></robot>";

// A cart cannot keep its leaning pole at rest: all programs report the torque that remains.
TEST_F(FindingsOfTheProgram, TorquesThatDoNotKeepAtRest) {
  std::ofstream(path("cart.urdf")) << kCart;
  const auto cart = [&](const std::string& name, const std::string& u, double q) {
    std::ofstream(path(name)) << "<scene><robot name='r' urdf='cart.urdf'" + u + "><joint name='pole' q='" +
                                     std::to_string(q) + "' actuated='false'/></robot></scene>";
    return path(name);
  };
  const std::string text = "no torques keep this coordinate at rest in this configuration: a load of 1.91 N m remains";
  const std::string gravity = cart("gravity.xml", " u='gravity'", 0.4), none = cart("none.xml", "", 0.4),
                    upright = cart("upright.xml", " u='gravity'", 0);
  expect_contains(run({"solve", gravity}).out, "rest: r/pole (gravity.xml:1): " + text);
  expect_contains(run({"inspect", gravity}).out, "rest: r/pole (gravity.xml:1): " + text);
  const json simulated = simulate(gravity, {});
  expect_contains(said_, "rest: r/pole (gravity.xml:1): " + text);
  EXPECT_EQ(simulated.at("findings")[0].at("kind"), "rest");
  const std::string both = run({"solve", gravity, "--quasi-static"}).out;
  expect_contains(both, "Quasi-static torques, which do not keep the scene at rest");
  EXPECT_EQ(both.find("rest: r/pole"), both.rfind("rest: r/pole"));  // once
  EXPECT_EQ(run({"solve", none}).out.find("rest: "), std::string::npos);
  expect_contains(run({"solve", none, "--quasi-static"}).out, "rest: r/pole: " + text);
  const json j = solve({none, "--quasi-static"});
  ASSERT_EQ(j.at("unbalanced").size(), 1u);
  EXPECT_EQ(j.at("unbalanced")[0].at("joint"), "r/pole");
  EXPECT_NEAR(j.at("unbalanced")[0].at("force").get<double>(), 9.81 * 0.5 * std::sin(0.4), 1e-9);
  EXPECT_EQ(j.at("findings").back().at("kind"), "rest");
  const std::string rests = run({"solve", upright, "--quasi-static"}).out;
  expect_contains(rests, "Quasi-static torques, which keep the scene at rest");
  EXPECT_EQ(rests.find("rest: "), std::string::npos) << rests;
  EXPECT_TRUE(solve({upright, "--quasi-static"}).at("unbalanced").empty());
}

}  // namespace
}  // namespace manycontact::cli
