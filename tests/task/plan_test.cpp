// Plans are checked for nodes without torques, closings, limits, goals and costs by term. Tight limits have three
// formulations; tasks are infeasible or not; weights have any scale.

#include "manycontact/task/plan.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <numbers>

#include "manycontact/task/simulate.hpp"
#include "support/dense.hpp"
#include "support/folder.hpp"
#include "support/scenes.hpp"

namespace manycontact {
namespace {

namespace fs = std::filesystem;
const std::string kShared = MANYCONTACT_SHARED_DIR;

// Reads a task with these files in its folder: name and text.
TaskFile task_with(const std::map<std::string, std::string>& files, const std::string& task) {
  const test::TemporaryFolder folder;
  for (const auto& [name, text] : files) (void)folder.write(name, text);
  return read_task(folder.write("task.xml", task));
}

TaskSolution solved(const TaskFile& task) {
  TaskProblem problem = make_problem(task);
  return optimize(task, problem, {{}, 1, {}});
}

const std::string kBox =
    "<robot name='box'><link name='box'><inertial><origin xyz='0 0 0.1'/><mass value='2'/>"
    "<inertia ixx='0.01' iyy='0.02' izz='0.03' ixy='0' ixz='0' iyz='0'/></inertial></link></robot>";

// Returns a bar of 0.5 m; `effort` is in N m.
std::string pendulum(const std::string& effort, const std::string& more = "lower='-7' upper='7' velocity='20'") {
  return "<robot name='pendulum'><link name='stand'/><link name='bar'><inertial><origin xyz='0 0 -0.5'/><mass "
         "value='1'/>"
         "<inertia ixx='0.02' iyy='0.02' izz='0.001' ixy='0' ixz='0' iyz='0'/></inertial></link>"
         "<joint name='swing' type='revolute'><parent link='stand'/><child link='bar'/><axis xyz='0 1 0'/>"
         "<limit effort='" +
         effort + "' " + more + "/></joint></robot>";
}

// Returns the same with a frame at its end.
std::string pendulum_with_tip() {
  std::string urdf = pendulum("100");
  urdf.insert(urdf.rfind("</robot>"),
              "<link name='tip'/><joint name='f' type='fixed'><origin xyz='0 0 -1'/><parent link='bar'/><child "
              "link='tip'/></joint>");
  return urdf;
}

// ---- nodes without torques

class WithoutTorques : public testing::TestWithParam<std::string> {};

// A free box is at z - g h^2 n (n + 1) / 2 after n steps of symplectic Euler, at z - g t^2 / 2 with Runge-Kutta.
TEST_P(WithoutTorques, ABoxFalls) {
  const TaskFile task =
      task_with({{"box.urdf", kBox},
                 {"scene.xml", "<scene><robot name='b' urdf='box.urdf' base='floating' xyz='0 0 5'/></scene>"}},
                "<task scene='scene.xml' step='0.02' integrator='" + GetParam() +
                    "'><phase nodes='50'><cost name='x' type='state' weight='1e-3'/></phase>"
                    "<terminal><cost name='x' type='state'/></terminal></task>");
  const double fallen = GetParam() == "euler" ? 9.81 * 0.02 * 0.02 * 50 * 51 / 2 : 9.81 / 2;
  for (const TaskSolver solver : {TaskSolver::kFddp, TaskSolver::kBoxFddp, TaskSolver::kSparse, TaskSolver::kAuto}) {
    TaskProblem problem = make_problem(task, solver);
    const TaskSolution s = optimize(task, problem, {solver, 1, {}});
    EXPECT_TRUE(s.converged) << s.reason;
    EXPECT_NEAR(s.xs.back()[2], 5 - fallen, 1e-9) << to_string(solver);
  }
}
INSTANTIATE_TEST_SUITE_P(By, WithoutTorques, testing::Values("euler", "rk2", "rk3", "rk4"));

// Next to a robot with torques the box is a part of its own.
TEST(WithoutTorquesBeside, ABoxFallsTheSame) {
  const TaskFile task = task_with(
      {{"box.urdf", kBox},
       {"p.urdf", pendulum("20")},
       {"scene.xml",
        "<scene><robot name='p' urdf='p.urdf'/><robot name='b' urdf='box.urdf' base='floating' xyz='0 0 5'/></scene>"}},
      "<task scene='scene.xml' step='0.02'><phase nodes='10'><cost name='x' type='state' weight='1e-3'/>"
      "<cost name='u' type='control' weight='1e-2'/></phase></task>");
  for (const TaskSolver solver : {TaskSolver::kFddp, TaskSolver::kBoxFddp, TaskSolver::kSparse, TaskSolver::kAuto}) {
    TaskProblem problem = make_problem(task, solver);
    EXPECT_EQ(problem.parts.size(), solver == TaskSolver::kFddp ? 1u : 2u);
    const TaskSolution s = optimize(task, problem, {solver, 1, {}});
    EXPECT_TRUE(s.converged) << s.reason;
    EXPECT_NEAR(s.xs.back()[3], 5 - 9.81 * 0.02 * 0.02 * 10 * 11 / 2, 1e-9) << to_string(solver);
  }
}

// ---- tight limits: torques too small for the bar, in three formulations, from two guesses

std::string lower(const std::string& limit, const std::string& solver) {
  return "<task scene='scene.xml' step='0.02'><phase nodes='100'><cost name='c' type='control' weight='1e-2'/>"
         "<cost name='x' type='state' reference='0 0'/>" +
         limit + "</phase><terminal><cost name='x' type='state' reference='0 0' weight='100'/></terminal>" + solver +
         "</task>";
}

TEST(TightLimitsOfTasks, AreMetAtTheOptimumInThreeWays) {
  const std::string scene = "<scene><robot name='p' urdf='p.urdf'><joint name='swing' q='1.5'/></robot></scene>";
  const std::string by_control = "<constraint name='l' type='control' lower='-0.5' upper='0.5'/>",
                    by_effort = "<constraint name='l' type='joint_effort' lower='-0.5' upper='0.5'/>";
  for (const std::string guess : {"zero", "quasi_static"})
    for (const auto& [limit, solver] :
         {std::pair<std::string, std::string>{"", "box-fddp"}, {by_control, "fddp"}, {by_effort, "fddp"}}) {
      const TaskFile task =
          task_with({{"p.urdf", pendulum("0.5")}, {"scene.xml", scene}},
                    lower(limit, "<solver type='" + solver + "' iterations='300' guess='" + guess + "'/>"));
      const TaskSolution s = solved(task);
      EXPECT_TRUE(s.converged) << solver << " " << guess << " " << limit << ": " << s.reason;
      EXPECT_NEAR(s.cost, 271.0385, 1e-6 * 271.0385) << solver << " " << guess << " " << limit;
      EXPECT_LE(s.constraint_violation, 1e-9);
      double largest = 0;
      for (const Eigen::VectorXd& u : s.us) largest = std::max(largest, std::abs(u[0]));
      EXPECT_LE(largest, 0.5 + 1e-9);
    }
}

TEST(TightLimitsOfTasks, ThatLeaveNoTorqueAtAllLetTheBarSwing) {
  const std::string scene = "<scene><robot name='p' urdf='p.urdf'><joint name='swing' q='1.5'/></robot></scene>";
  const TaskFile task =
      task_with({{"p.urdf", pendulum("0.5")}, {"scene.xml", scene}},
                lower("<constraint name='l' type='control' lower='0' upper='0'/>", "<solver iterations='300'/>"));
  const TaskSolution s = solved(task);
  EXPECT_TRUE(s.converged) << s.reason;
  for (const Eigen::VectorXd& u : s.us) EXPECT_NEAR(u[0], 0, 1e-8);
}

// ---- infeasible or not

const char* const kCart =
    "<robot name='cart'><link name='w'/><link name='c'><inertial><mass value='1'/><inertia ixx='1' iyy='1' izz='1' "
    "ixy='0' "
    "ixz='0' iyz='0'/></inertial></link><joint name='x' type='prismatic'><parent link='w'/><child link='c'/>"
    "<axis xyz='1 0 0'/><limit effort='1000' velocity='1000' lower='-100' upper='100'/></joint></robot>";
const char* const kCartScene = "<scene><robot name='r' urdf='cart.urdf'/></scene>";

TEST(InfeasibleTasks, AreNoneOfACartWithoutLimits) {
  struct Case {
    int n;
    double h, w;
  };
  for (const Case c : {Case{10, 0.1, 1},
                       {10, 0.02, 1},
                       {10, 0.02, 1e-2},
                       {10, 0.02, 1e-4},
                       {3, 0.02, 1e-2},
                       {50, 0.01, 1},
                       {100, 0.01, 1e4}}) {
    std::ostringstream text;
    text << "<task scene='scene.xml' step='" << c.h << "'><phase nodes='" << c.n
         << "'><cost name='u' type='control' weight='" << c.w
         << "'/></phase><terminal><constraint name='end' type='state' reference='0.5 0' lower='0 0' upper='0 "
            "0'/></terminal>"
            "<solver iterations='500'/></task>";
    const TaskFile task = task_with({{"cart.urdf", kCart}, {"scene.xml", kCartScene}}, text.str());
    Eigen::MatrixXd S(2, c.n);
    for (int t = 0; t < c.n; ++t) S.col(t) << c.h * c.h * (c.n - t), c.h;
    const Eigen::VectorXd u = S.transpose() * test::solved(S * S.transpose(), Eigen::Vector2d(0.5, 0));
    const double right = 0.5 * c.h * c.w * u.squaredNorm();
    const TaskSolution s = solved(task);
    EXPECT_TRUE(s.converged) << c.n << " " << c.h << " " << c.w << ": " << s.reason;
    EXPECT_NEAR(s.cost, right, 1e-6 * right);
  }
}

// Hanging, the tip is furthest from its goal above: this is stationary, and yet the goal can be met.
TEST(InfeasibleTasks, AreNotThoseWhoseGuessIsAMaximum) {
  const TaskFile task = task_with(
      {{"p.urdf", pendulum("100")}, {"scene.xml", "<scene><robot name='p' urdf='p.urdf'/></scene>"}},
      "<task scene='scene.xml' step='0.02'><phase nodes='50'><cost name='u' type='control' weight='1e-4'/></phase>"
      "<terminal><constraint name='up' type='frame_rotation' frame='p/bar' quat_xyzw='0 1 0 0' lower='-1e-3 -1e-3 "
      "-1e-3' upper='1e-3 1e-3 1e-3'/></terminal>"
      "<solver iterations='500'/></task>");
  const TaskSolution s = solved(task);
  EXPECT_EQ(s.reason.find("infeasible"), std::string::npos) << s.reason;
  EXPECT_TRUE(s.converged) << s.reason;
}

// The goal is the tip's place: a Gauss-Newton step from nearby goes back, because it keeps the tip below the hinge.
TEST(InfeasibleTasks, AreNotThoseWhoseStepsGoBackToAMaximum) {
  const std::string urdf = pendulum_with_tip();
  const TaskFile task = task_with(
      {{"p.urdf", urdf}, {"scene.xml", "<scene><robot name='p' urdf='p.urdf'/></scene>"}},
      "<task scene='scene.xml' step='0.02'><phase nodes='50'><cost name='u' type='control' weight='1e-3'/></phase>"
      "<terminal><constraint name='up' type='frame_translation' frame='p/tip' xyz='0 0 1' lower='0 0 0' upper='0 0 "
      "0'/></terminal></task>");
  const TaskSolution s = solved(task);
  EXPECT_TRUE(s.converged) << s.reason;
  EXPECT_NEAR(std::abs(s.xs.back()[0]), std::numbers::pi, 1e-6);
}

// The tip of a 1 m bar has a goal 3 m from its hinge: pointing at it is the least violation, and proved to be so.
TEST(InfeasibleTasks, AreShownToBeSoWhereTheViolationIsStationary) {
  const std::string urdf = pendulum_with_tip();
  const TaskFile task = task_with(
      {{"p.urdf", urdf},
       {"scene.xml", "<scene><robot name='p' urdf='p.urdf'><joint name='swing' q='0.4'/></robot></scene>"}},
      "<task scene='scene.xml' step='0.02'><phase nodes='30'><cost name='u' type='control' weight='1e-4'/></phase>"
      "<terminal><constraint name='there' type='frame_translation' frame='p/tip' xyz='-3 0 0' lower='0 0 0' "
      "upper='0 0 0'/></terminal><solver iterations='500'/></task>");
  const TaskSolution s = solved(task);
  EXPECT_EQ(s.reason.rfind("infeasible constraints: there, by 2 at node 30", 0), 0u) << s.reason;
  EXPECT_NEAR(s.constraint_violation, 2, 1e-6);
}

// ---- weights of any scale

TEST(WeightsOfTasks, TimesAnythingGiveTheSameMotion) {
  Eigen::VectorXd first;
  for (const double s : {1.0, 1e-12, 1e-10, 1e-8, 1e-6, 1e-3, 1e3, 1e6, 1e9, 1e12}) {
    std::ostringstream text;
    text.precision(17);
    text << "<task scene='scene.xml' step='0.05'><phase nodes='20'><cost name='u' type='control' weight='" << 1e-3 * s
         << "'/></phase><terminal><cost name='x' type='state' reference='1 0' weight='" << s << "'/></terminal></task>";
    const TaskFile task = task_with({{"cart.urdf", kCart}, {"scene.xml", kCartScene}}, text.str());
    const TaskSolution found = solved(task);
    EXPECT_TRUE(found.converged) << s << ": " << found.reason;
    if (first.size() == 0) first = found.xs.back();
    EXPECT_LE((found.xs.back() - first).lpNorm<Eigen::Infinity>(), 1e-6) << s;
    EXPECT_NEAR(first[0], 0.988, 1e-3);
  }
}

// ---- a guess that is a maximum

TEST(StationaryGuesses, ThatAreNoMinimaAreLeftAndTold) {
  const std::string text =
      "<task scene='scene.xml' step='0.02'><phase nodes='100'><cost name='u' type='control' "
      "weight='1e-4'/></phase><terminal>"
      "<cost name='up' type='frame_translation' frame='p/tip' xyz='0 0 1' weight='100'/></terminal><solver "
      "iterations='500'/></task>";
  const std::string urdf = pendulum_with_tip();
  const TaskFile task =
      task_with({{"p.urdf", urdf}, {"scene.xml", "<scene><robot name='p' urdf='p.urdf'/></scene>"}}, text);
  const TaskSolution s = solved(task);
  EXPECT_LT(s.cost, 10) << s.reason;  // 200 if it hangs
  EXPECT_NE(s.reason.find("stationary"), std::string::npos) << s.reason;
  ASSERT_EQ(s.remarks.size(), 1u);
}

// ---- reports on plans

// A falling box has a contact that closes while the box is 0.3 m above it.
TEST(Plans, TellContactsThatCloseInTheAir) {
  const TaskFile task = task_with(
      {{"box.urdf", kBox},
       {"scene.xml",
        "<scene><robot name='b' urdf='box.urdf' base='floating' xyz='0 0 1'/>"
        "<contact name='foot' type='3d' frame='b/box' reference_frame='world' xyz='0 0 0.5'/></scene>"}},
      "<task scene='scene.xml' step='0.02'><phase nodes='10' contacts=''><cost name='x' type='state'/></phase>"
      "<phase nodes='5' contacts='foot' impact='true'><cost name='x' type='state'/></phase></task>");
  const TaskSolution s = solved(task);
  const std::vector<PlanClosing> all = closings(task, s.xs);
  ASSERT_EQ(all.size(), 1u);
  EXPECT_EQ(all[0].node, 10u);
  EXPECT_NEAR(all[0].above, 0.5 - 9.81 * 0.02 * 0.02 * 55, 1e-9);
  EXPECT_NEAR(all[0].speed, 9.81 * 0.2, 1e-9);
  const auto findings = plan_findings(task, s, {});
  ASSERT_EQ(findings.size(), 1u);
  EXPECT_EQ(findings[0].kind, "closes");
  EXPECT_EQ(findings[0].name, "foot");
}

// The contact's gains would drag the box to the scene's reference. It is fixed where it closed instead, in the plan and
// in its simulation, unless the phase requests otherwise.
TEST(Plans, HoldContactsWhereTheyClosed) {
  for (const std::string gains : {"0 20", "400 40"})
    for (const bool at_scene : {false, true}) {
      const TaskFile task = task_with(
          {{"box.urdf", kBox},
           {"scene.xml",
            "<scene><robot name='b' urdf='box.urdf' base='floating' xyz='0 0 1'/>"
            "<contact name='foot' type='3d' frame='b/box' reference_frame='world' xyz='0 0 0.5' gains='" +
                gains + "'/></scene>"}},
          "<task scene='scene.xml' step='0.01'><phase nodes='10' contacts=''><cost name='x' type='state'/></phase>"
          "<phase nodes='60' contacts='foot' impact='true'" +
              std::string(at_scene ? " at='scene'" : "") + "><cost name='x' type='state'/></phase></task>");
      const TaskSolution s = solved(task);
      const double closed = s.xs[10][2], end = s.xs.back()[2];
      if (at_scene && gains != "0 20")
        EXPECT_LT(std::abs(end - 0.5), 0.05);
      else
        EXPECT_NEAR(end, closed, 1e-3) << gains;
      const SimulatedMotion simulated = simulate(task, s, Integrator::kSemiImplicitEuler, 10);
      EXPECT_NEAR(simulated.xs.back()[2], at_scene ? 0.5 : closed, 0.05) << gains << at_scene;
    }
}

TEST(Plans, TellLimitsThatArePassedAndGoalsThatAreMissed) {
  const TaskFile task = task_with({{"p.urdf", pendulum("1", "lower='-0.5' upper='0.5' velocity='0.1'")},
                                   {"scene.xml", "<scene><robot name='p' urdf='p.urdf'/></scene>"}},
                                  "<task scene='scene.xml' step='0.02'><phase nodes='50'><cost name='u' type='control' "
                                  "weight='1e-4'/></phase><terminal>"
                                  "<cost name='there' type='state' reference='1 0' weight='100'/><cost name='far' "
                                  "type='com' reference='3 0 0' weight='1'/></terminal></task>");
  TaskProblem problem = make_problem(task);
  const TaskSolution s = optimize(task, problem, {{}, 1, {}});
  problem.problem->calc(s.xs, s.us);
  const std::vector<PlanCost> costs = cost_by_term(task, problem);
  std::map<std::string, PlanFinding> by_kind;
  for (const PlanFinding& f : plan_findings(task, s, costs)) by_kind[f.kind] = f;
  ASSERT_TRUE(by_kind.count("position") && by_kind.count("velocity") && by_kind.count("effort") &&
              by_kind.count("goal"));
  EXPECT_EQ(by_kind["position"].name, "p/swing");
  EXPECT_EQ(by_kind["goal"].name, "far");
}

// A loop whose axes are rounded stands still, and the plan with it.
TEST(Plans, TellNearlyDependentRows) {
  for (const double tilt : {1e-5, 0.0}) {
    TaskFile task;
    task.scene = test::tilted_four_bar(tilt);
    task.step = 0.01;
    TaskPhase phase;
    phase.active = {true};
    phase.nodes = 3;
    task.phases = {phase};
    Eigen::VectorXd x(task.scene.scene.nq + task.scene.scene.nv);
    x << task.scene.q, task.scene.v;
    TaskSolution s;
    s.xs = {x, x, x, x};
    s.us = {task.scene.u, task.scene.u, task.scene.u};
    const auto findings = plan_findings(task, s, {});
    ASSERT_EQ(findings.size(), tilt > 0 ? 1u : 0u);
    if (tilt == 0) continue;
    EXPECT_EQ(findings[0].kind, "near_dependent");
    EXPECT_EQ(findings[0].name, "pin[2]");
    EXPECT_EQ(findings[0].node, 0u);
  }
}

// For every integrator and solver the costs of the terms add up to the whole.
TEST(Plans, CostsByTermAddUp) {
  const std::string models = MANYCONTACT_SOURCE_DIR "/models/tasks/";
  for (const std::string name : {"humanoid_reaches.xml", "quadruped_trots.xml", "two_humanoids_lift_beam.xml"})
    for (const TaskIntegrator integrator : {TaskIntegrator::kEuler, TaskIntegrator::kRk4}) {
      TaskFile task = read_task(models + name);
      task.integrator = integrator;
      TaskProblem problem = make_problem(task);
      const double all = problem.problem->calc(problem.xs, problem.us);
      double sum = 0;
      for (const PlanCost& cost : cost_by_term(task, problem)) sum += cost.cost;
      EXPECT_NEAR(sum, all, 1e-12 * std::abs(all)) << name;
    }
}

// ---- memory, defaults, multipliers

TEST(Problems, OfMoreNodesThanThereIsMemoryForAreRefusedBefore) {
  TaskFile task = read_task(MANYCONTACT_SOURCE_DIR "/models/tasks/humanoid_reaches.xml");
  task.phases[0].nodes = 1000000;
  try {
    (void)make_problem(task);
    ADD_FAILURE() << "it was made";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("of memory"), std::string::npos) << error.what();
  }
}

TEST(Problems, AreOfTheTasksOwnSolverByDefault) {
  TaskFile task = task_with(
      {{"p.urdf", pendulum("2")}, {"scene.xml", "<scene><robot name='p' urdf='p.urdf'/></scene>"}},
      "<task scene='scene.xml' step='0.02'><phase nodes='20'><cost name='u' type='control' weight='1e-2'/></phase>"
      "<terminal><cost name='x' type='state' reference='3 0' weight='100'/></terminal><solver type='box-fddp' "
      "iterations='300'/></task>");
  const TaskSolution s = solved(task);
  EXPECT_EQ(s.solver, "box-fddp");
  for (const Eigen::VectorXd& u : s.us) EXPECT_LE(std::abs(u[0]), 2);
}

// From its own solution, multipliers included, a constrained task needs no iteration.
TEST(Multipliers, AreTakenAlongToAWarmStart) {
  const TaskFile task = task_with(
      {{"cart.urdf", kCart}, {"scene.xml", kCartScene}},
      "<task scene='scene.xml' step='0.02'><phase nodes='20'><cost name='u' type='control'/></phase><terminal>"
      "<constraint name='end' type='state' reference='0.5 0' lower='0 0' upper='0 0'/></terminal><solver "
      "iterations='500'/></task>");
  TaskProblem problem = make_problem(task);
  const TaskSolution cold = optimize(task, problem, {{}, 1, {}});
  ASSERT_TRUE(cold.converged);
  problem.xs = cold.xs;
  problem.us = cold.us;
  problem.multipliers = cold.multipliers;
  const TaskSolution warm = optimize(task, problem, {{}, 1, {}});
  EXPECT_TRUE(warm.converged) << warm.reason;
  EXPECT_LT(warm.iterations.size(), 1 + cold.iterations.size() / 2);
  EXPECT_NEAR(warm.cost, cold.cost, 1e-8 * cold.cost);
}

// The root has no inertia, and its only body turns on a hinge: nothing resists turns of the root about the hinge. A
// contact can fix the root.
TEST(Plans, NameTheJointsThatMakeDynamicsFail) {
  const std::map<std::string, std::string> files = {
      {"body.urdf",
       "<robot name='r'><link name='w'/><link name='b'><inertial><origin xyz='0.3 0 0'/><mass value='1'/><inertia "
       "ixx='0.1' iyy='0.2' izz='0.3' ixy='0' ixz='0' iyz='0'/></inertial></link><joint name='j' type='continuous'>"
       "<parent link='w'/><child link='b'/><axis xyz='0 1 0'/></joint></robot>"},
      {"scene.xml",
       "<scene><robot name='q' urdf='body.urdf' base='floating'/><contact name='c' type='6d' frame='q/w'/></scene>"}};
  const std::string costs = "><cost name='u' type='control' weight='1e-2'/></phase>";
  const std::string phases[] = {"<phase nodes='8' contacts=''" + costs,
                                "<phase nodes='4' contacts='c'" + costs + "<phase nodes='4' contacts=''" + costs};
  for (const std::string solver : {"fddp", "box-fddp", "sparse", "auto"})
    for (const std::string integrator : {"euler", "rk4", "symplectic"})
      for (const bool constrained : {false, true})
        for (const std::size_t k : {0, 1}) {
          const std::string constraint =
              "<constraint name='b' type='frame_translation' frame='q/b' xyz='0 0 0' lower='-9 -9 -9' upper='9 9 9'/>";
          const TaskFile task = task_with(files, "<task scene='scene.xml' step='0.01' integrator='" + integrator +
                                                     "'>" + phases[k] + "<terminal>" + (constrained ? constraint : "") +
                                                     "</terminal><solver type='" + solver + "'/></task>");
          const TaskSolution s = solved(task);
          ASSERT_FALSE(s.converged);
          ASSERT_EQ(s.failures.size(), 1u) << solver << " " << integrator << " " << s.reason;
          EXPECT_EQ(s.failures[0].node, 4 * k);
          EXPECT_EQ(s.failures[0].name, "q/root");
          EXPECT_NE(s.reason.find("q/root: the joint's bodies lack mass"), std::string::npos) << s.reason;
          const auto findings = plan_findings(task, s, {});
          ASSERT_FALSE(findings.empty());
          EXPECT_EQ(findings[0].kind, "no_inertia");
        }
}

// ---- rows of ../shared, where present

class Control : public testing::TestWithParam<std::pair<const char*, double>> {};
GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(Control);

TEST_P(Control, FindsTheOptimum) {
  const std::string path = kShared + "/" + GetParam().first;
  if (!fs::exists(path)) GTEST_SKIP() << "skipped: no " << path;
  const TaskFile task = read_task(path);
  const TaskSolution s = solved(task);
  EXPECT_TRUE(s.converged) << path << ": " << s.reason;
  EXPECT_NEAR(s.cost, GetParam().second, 1e-6 * std::max(1.0, GetParam().second)) << path << ": " << s.reason;
}
INSTANTIATE_TEST_SUITE_P(Of, Control,
                         testing::Values(std::pair{"reports/tight_limits/weak_box.xml", 271.0385},
                                         std::pair{"reports/tight_limits/weak_constraint.xml", 271.0385},
                                         std::pair{"control/01-5d-bond/task_sparse.xml", 5.505787593},
                                         std::pair{"control/01-5d-bond/task_auto.xml", 5.505787593},
                                         std::pair{"control/08-damping-hides-dependent-bonds/task.xml",
                                                   0.00041582976523},
                                         std::pair{"control/09-bond-schur/no_direction/task.xml", 0.009372919961545},
                                         std::pair{"control/10-saddle-converged/task_beside.xml", 0.0456352}));

TEST(DeepRobots, HaveContactsAndResidualsToo) {
  for (const char* folder : {"/control/02-control-grav-sparse-bodies", "/control/03-deep-robot-with-contact"}) {
    if (!fs::exists(kShared + folder)) GTEST_SKIP() << "skipped: no " << folder;
    const TaskSolution s = solved(read_task(kShared + folder + "/task.xml"));
    EXPECT_TRUE(s.converged) << folder << ": " << s.reason;
  }
}

TEST(ContactCosts, OfTwoContactsOfOneLinkAreEachItsOwn) {
  const std::string path = kShared + "/control/07-contact-costs-of-one-link/task.xml";
  if (!fs::exists(path)) GTEST_SKIP() << "skipped: no " << path;
  EXPECT_NO_THROW((void)make_problem(read_task(path)));
}

}  // namespace
}  // namespace manycontact
