// The residual of the optimality conditions is compared with differences of the cost, and checked at optima.

#include <gtest/gtest.h>

#include <filesystem>

#include "manycontact/control/euler.hpp"
#include "manycontact/task/optimize.hpp"
#include "support/random.hpp"
#include "task/task_of.hpp"

namespace manycontact::test {
namespace {

// Returns the cost of the torques over their rollout.
double total_cost(ShootingProblem& problem, const std::vector<Eigen::VectorXd>& us) {
  return problem.calc(problem.rollout_us(us), us);
}

// Returns multipliers that satisfy the conditions in x: l_T = lx_T, l_t = lx_t + fx_t^T l_(t+1).
std::vector<Eigen::VectorXd> adjoint(ShootingProblem& problem, const std::vector<Eigen::VectorXd>& xs,
                                     const std::vector<Eigen::VectorXd>& us) {
  problem.calc(xs, us);
  problem.calcDiff(xs, us);
  std::vector<Eigen::VectorXd> l(xs.size(), problem.get_terminalData()->Lx);
  for (std::size_t t = us.size(); t-- > 0;) {
    const ActionDataAbstract& data = *problem.get_runningDatas()[t];
    l[t] = data.Lx + data.Fx.transpose() * l[t + 1];
  }
  return l;
}

// On a rollout the gaps are zero and stationarity is the gradient of the total cost: central differences with step h
// are accurate to h^2 and eps |cost| / h.
TEST(KktResidual, IsTheGradientOnARollout) {
  TaskFile task = read_task(kTasks + "humanoid_reaches.xml");
  for (TaskPhase& phase : task.phases) phase.nodes = 3;
  TaskProblem p = make_problem(task, TaskSolver::kFddp);
  const std::vector<Eigen::VectorXd> us = p.us;
  double largest = 0;
  constexpr double h = 1e-4;
  for (std::size_t t = 0; t < us.size(); ++t)
    for (Eigen::Index i = 0; i < us[t].size(); ++i) {
      std::vector<Eigen::VectorXd> more = us, less = us;
      more[t][i] += h;
      less[t][i] -= h;
      largest = std::max(largest, std::abs(total_cost(*p.problem, more) - total_cost(*p.problem, less)) / (2 * h));
    }
  ASSERT_GT(largest, 1e-3);
  const std::vector<Eigen::VectorXd> xs = p.problem->rollout_us(us);
  EXPECT_NEAR(kkt_residual(*p.problem, xs, us, adjoint(*p.problem, xs, us), false), largest, 1e-6 * largest);
}

// The stopping value is an energy; the residual decreases with its square root. A gap appears as it is.
TEST(KktResidual, GoesToZeroWithTheStoppingValueAndSeesGaps) {
  TaskFile task = read_task(kTasks + "humanoid_reaches.xml");
  task.tolerance = 1e-16;
  TaskProblem p = make_problem(task, TaskSolver::kFddp);
  TaskSolution s = optimize(task, p, {TaskSolver::kFddp, 1, {}});
  EXPECT_TRUE(s.converged) << s.reason;
  EXPECT_LT(s.kkt_residual, 1e-7);
  s.xs.back()[3 + 4 + 5] += 10;  // a joint of the terminal state
  EXPECT_GE(kkt_residual(*p.problem, s.xs, s.us, adjoint(*p.problem, s.xs, s.us), false), 10 * (1 - 1e-9));
}

}  // namespace
}  // namespace manycontact::test
