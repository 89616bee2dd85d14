// An optimized motion is simulated, with its contact forces.

#include <gtest/gtest.h>

#include "manycontact/action/cones.hpp"
#include "manycontact/task/forces.hpp"
#include "manycontact/task/simulate.hpp"
#include "task/task_of.hpp"

namespace manycontact::test {
namespace {

// Expects that soles neither slip nor tip, in every row of the cones of the task's barrier costs.
void expect_within_cones(const TaskFile& task, const TaskProblem& problem, const TaskSolution& s) {
  problem.problem->calc(s.xs, s.us);
  const WrenchCone cone(Eigen::Matrix3d::Identity(), 0.6, {0.2, 0.09});
  for (std::size_t t = 0; t < s.us.size(); ++t) {
    const std::vector<Eigen::VectorXd> forces = contact_forces(task, problem, t);
    for (const char* foot : {"a_left_foot", "a_right_foot", "b_left_foot", "b_right_foot"}) {
      const Eigen::VectorXd& f = forces[static_cast<std::size_t>(task.scene.scene.contact_index.at(foot))];
      const Eigen::VectorXd rows = cone.get_A() * f;
      EXPECT_GT(f[2], 50) << foot << t;
      EXPECT_LE((rows - cone.get_ub()).maxCoeff(), 0) << foot << t;
      EXPECT_LE((cone.get_lb() - rows).maxCoeff(), 0) << foot << t;
    }
  }
}

// The task's nodes are 20 ms apart. With steps of 1 ms and the solver's feedback at the nodes, the closed loops remain
// closed and the beam follows the plan. Torques alone would let the humanoids fall.
TEST(SimulatedMotion, TwoHumanoidsLiftABeam) {
  const TaskFile task = read_task(kTasks + "two_humanoids_lift_beam.xml");
  TaskProblem problem = make_problem(task);
  TaskSolution s = optimize(task, problem, {TaskSolver::kAuto, 1, {}});
  ASSERT_TRUE(s.converged) << s.reason;
  const Scene& scene = task.scene.scene;
  const int z = scene.robots[static_cast<std::size_t>(scene.robot_index.at("beam"))].idx_q + 2;
  for (const Integrator integrator : {Integrator::kRk4, Integrator::kSemiImplicitEuler}) {
    const SimulatedMotion motion = simulate(task, s, integrator, 20);
    EXPECT_EQ(motion.stopped, StepStatus::kOk);
    // The step in axes that rest (issue 68, item 1) has a first-order drift of 1.09e-6 m; that of RK4 is below 1e-6 m.
    EXPECT_LT(motion.violation_position, integrator == Integrator::kRk4 ? 1e-6 : 1.5e-6);
    EXPECT_LT(motion.distance, 0.2);  // including velocities
    double highest = 0;
    for (const Eigen::VectorXd& x : motion.xs) highest = std::max(highest, x[z] - task.scene.q[z]);
    EXPECT_NEAR(highest, 0.2, 0.01);
    EXPECT_NEAR(motion.xs.back()[z], task.scene.q[z], 0.01);
  }
  expect_within_cones(task, problem, s);
  s.gains.clear();
  EXPECT_GT(simulate(task, s, Integrator::kRk4, 5).distance, 1);
}

// Returns the largest component of x (-) xs at the nodes first ... last, including velocities.
double distance(const TaskProblem& problem, const TaskSolution& s, const SimulatedMotion& motion, std::size_t first,
                std::size_t last) {
  double out = 0;
  for (std::size_t t = first; t <= last; ++t)
    out = std::max(out, problem.state->diff_dx(s.xs[t], motion.xs[t]).lpNorm<Eigen::Infinity>());
  return out;
}

// Two landings have the plan's impacts, so that the motion follows it right after them. (Before them feet come down
// fast: velocities that are late by a step have large errors.) A plan without impacts lets the feet move on for a
// while.
TEST(SimulatedMotion, AQuadrupedTrots) {
  TaskFile task = read_task(kTasks + "quadruped_trots.xml");
  for (const bool impacts : {true, false}) {
    for (TaskPhase& phase : task.phases) phase.impact = phase.impact && impacts;
    TaskProblem problem = make_problem(task);
    const TaskSolution s = optimize(task, problem, {TaskSolver::kAuto, 1, {}});
    ASSERT_TRUE(s.converged) << s.reason;
    const SimulatedMotion motion = simulate(task, s, Integrator::kRk4, 10);
    EXPECT_EQ(motion.stopped, StepStatus::kOk);
    ASSERT_EQ(motion.xs.size(), s.xs.size());
    EXPECT_LT(motion.violation_position, 1e-6);
    EXPECT_GT(motion.energy_lost, 1e-3);
    EXPECT_LT((motion.xs.back() - s.xs.back()).head(3).lpNorm<Eigen::Infinity>(), 5e-3);
    EXPECT_GT(motion.xs.back()[0] - motion.xs.front()[0], 0.05);  // forward
    if (impacts) {
      EXPECT_LT(distance(problem, s, motion, 0, 23), 0.2);
      EXPECT_LT(distance(problem, s, motion, 25, 46), 0.2);
      EXPECT_LT(distance(problem, s, motion, 48, 56), 0.2);
    } else {
      EXPECT_GT(distance(problem, s, motion, 24, 27), 0.3);
    }
  }
}

}  // namespace
}  // namespace manycontact::test
