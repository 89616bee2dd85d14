// Phases that begin with an impact have nodes, times, and the effect of the impact.

#include <gtest/gtest.h>

#include <random>

#include "manycontact/simulation/switch.hpp"
#include "manycontact/task/forces.hpp"
#include "manycontact/task/optimize.hpp"
#include "manycontact/task/violations.hpp"
#include "support/random.hpp"
#include "support/scenes.hpp"
#include "task/task_of.hpp"

namespace manycontact::test {
namespace {

TEST(Impact, IsANodeBeforeThoseOfItsPhase) {
  const TaskFile task = read_task(kTasks + "quadruped_trots.xml");
  const std::vector<TaskNode> nodes = timeline(task);
  ASSERT_EQ(nodes.size(), 57u);
  EXPECT_EQ(task.nodes(), 56);
  for (std::size_t t = 0; t < nodes.size(); ++t) EXPECT_EQ(nodes[t].impact, t == 24 || t == 47) << t;
  EXPECT_EQ(nodes[23].phase, 2);
  EXPECT_EQ(nodes[24].phase, 3);
  EXPECT_EQ(nodes[25].phase, 3);
  EXPECT_EQ(nodes[24].time, nodes[25].time);
  EXPECT_DOUBLE_EQ(nodes[25].time, 0.24);
  EXPECT_EQ(nodes[56].phase, 7);
  EXPECT_DOUBLE_EQ(nodes[56].time, 0.54);
  EXPECT_EQ(&phase_at(task, nodes[56]), &task.terminal);
  const TaskProblem problem = make_problem(task, TaskSolver::kFddp);
  EXPECT_EQ(problem.problem->get_T(), 56u);
  EXPECT_EQ(problem.xs.size(), 57u);
  for (std::size_t t = 0; t < 56; ++t) EXPECT_EQ(problem.us[t].size(), nodes[t].impact ? 0 : 12) << t;
  problem.problem->calc(problem.xs, problem.us);
  for (const Eigen::VectorXd& f : contact_forces(task, problem, 24)) EXPECT_EQ(f.size(), 0);
  for (const Eigen::VectorXd& f : contact_forces(task, problem, 25)) EXPECT_EQ(f.size(), 3);
}

// The node's jump is that of the simulation, which has tests of its own; contacts are far from their references.
TEST(Impact, IsThatOfTheSimulation) {
  TaskFile task = read_task(kTasks + "quadruped_trots.xml");
  for (Contact& contact : task.scene.scene.contacts) contact.alpha = 7;  // an impact has no error to correct
  const Scene& scene = task.scene.scene;
  const TaskProblem problem = make_problem(task, TaskSolver::kFddp);
  std::mt19937 rng(1);
  const Eigen::VectorXd x = problem.state->integrate_x(problem.xs[24], random_vector(36, rng, 0.3));
  SimulationData sim(scene, x.head(scene.nq), x.tail(scene.nv), Integrator::kRk4, 1e-3);
  sim.dynamics.active = {0, 1, 1, 0};
  EXPECT_GT(switch_contacts(scene, {1, 1, 1, 1}, sim).energy_lost, 0.1);
  const auto& model = problem.problem->get_runningModels()[24];
  const auto data = model->createData();
  model->calc(data, x);
  EXPECT_EQ(data->cost, 0);
  EXPECT_EQ(data->xnext.head(scene.nq), x.head(scene.nq));
  const Eigen::VectorXd v = data->xnext.tail(scene.nv);
  EXPECT_LT((v - sim.v).norm(), 1e-11 * v.norm());
  EXPECT_GT((v - x.tail(scene.nv)).norm(), 0.1);
}

// Constraints on the state apply to the last state of their phase too, before the impact: a tool that is moved down
// stays above its bound there.
TEST(Impact, HasTheConstraintsOfThePhaseThatEnds) {
  const std::string scene = "<scene gravity='0 0 0'><robot name='a' urdf='" + kModels +
                            "arm.urdf'><q>0 0.5 0 1 0 0.5 0</q></robot>"
                            "<contact name='c' type='3d' frame='a/tool'/></scene>";
  const std::string costs = "<cost name='u' type='control' weight='1e-2'/>";
  const TaskFile task = task_of(
      "t", scene,
      "<phase nodes='6' contacts=''>" + costs +
          "<cost name='down' type='frame_velocity' frame='a/tool' reference_frame='world' twist='0 0 -2 0 0 0' "
          "weight='10'/><constraint name='above' type='frame_translation' frame='a/tool' xyz='0 0 0' lower='-inf -inf "
          "0.6' upper='inf inf inf'/><constraint name='torques' type='control' lower='" +
          repeated("-500", 7) + "' upper='" + repeated("500", 7) +
          "'/></phase><phase nodes='2' contacts='c' impact='true'>" + costs + "</phase>");
  TaskProblem problem = make_problem(task, TaskSolver::kFddp);
  EXPECT_EQ(problem.problem->model(6)->get_ng(), 1u);  // the height's; an impact has no torques
  problem.problem->calc(problem.xs, problem.us);
  EXPECT_NEAR(problem.problem->data(6)->g[0], problem.problem->data(5)->g[0], 1e-12);
  const std::vector<TaskViolation> missed = violations(problem);
  ASSERT_EQ(missed.size(), 2u);
}

}  // namespace
}  // namespace manycontact::test
