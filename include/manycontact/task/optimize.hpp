#pragma once
// A task solved, and what a solver did.

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "manycontact/control/solver.hpp"
#include "manycontact/task/problem.hpp"

namespace manycontact {

/// What a solver's callback sees after an iteration; gaps are those before it. Cost is the task's own, the others are
/// of the augmented problem where there are constraints.
struct TaskIteration {
  double cost = 0, stop = 0, regularisation = 0, step_length = 0, gaps = 0;
  bool feasible = false;
};

/// Per running node, medians over the iterations [us]; total [us].
struct TaskTimes {
  double calc = 0;       // forward pass: controls, dynamics, costs
  double calc_diff = 0;  // their derivatives
  double direction = 0;  // backward pass
  double total = 0;
};

struct TaskSolution {
  bool converged = false;
  double cost = 0;
  std::string reason;  // why it stopped
  std::vector<TaskIteration> iterations;
  std::vector<Eigen::VectorXd> xs, us;  // nodes + 1, nodes
  std::string solver;
  std::vector<int> blocks;  // sizes of the matrices factorized at a node
  double kkt_residual = 0;
  double constraint_violation = 0;  // largest over all nodes and rows
  TaskTimes times;
};

struct TaskOptions {
  TaskSolver solver = TaskSolver::kAuto;
  int threads = 0;  // 0: OpenMP's
  /// After each iteration; false ends the solve there.
  std::function<bool(const TaskIteration&)> each = {};
};

/// Why the solver cannot be had; empty when it can.
std::string why_not(TaskSolver solver);

/// From the problem's guess, with the task's iterations and tolerance. Constraints are met by rounds of an augmented
/// Lagrangian (augmented.hpp), to 5e-9. Throws InputError, with the line of the task's <solver>, where why_not says
/// something. Numerical failure is no exception: `reason` says it.
TaskSolution optimize(const TaskFile& task, TaskProblem& problem, const TaskOptions& options);

/// The largest violation of the optimality conditions of a shooting problem (g and h are left out), at states, controls
/// and multipliers l_0 ... l_T of the dynamics:
///
///     gaps               x0 (-) x_0,  f_t(x_t, u_t) (-) x_(t+1)
///     stationarity in x  lx_t + fx_t^T l_(t+1) - l_t,  lx_T - l_T
///     stationarity in u  lu_t + fu_t^T l_(t+1)
///
/// Where the problem has limits on controls and they are used, the last is u - min(max(u - that, u_lb), u_ub). The
/// nodes are evaluated, with derivatives, at xs, us. Infinite where a number is not finite.
double kkt_residual(ShootingProblem& problem, const std::vector<Eigen::VectorXd>& xs,
                    const std::vector<Eigen::VectorXd>& us, const std::vector<Eigen::VectorXd>& multipliers,
                    bool limits);

}  // namespace manycontact
