#pragma once
// Solves a task, and reports what the solver did.

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "manycontact/control/kkt_residual.hpp"
#include "manycontact/task/violations.hpp"

namespace manycontact {

/// The values after an iteration; `gaps` is the norm of the gaps before this iteration. `cost` is the task's cost. With
/// constraints, the other values refer to the augmented Lagrangian.
struct TaskIteration {
  double cost = 0, stop = 0, regularisation = 0, step_length = 0, gaps = 0;
  bool feasible = false;
};

/// Times per running node, medians over the iterations [us]. `total` is the time of the whole solve [us].
struct TaskTimes {
  double calc = 0;       // forward pass: controls, dynamics and costs
  double calc_diff = 0;  // derivatives of the forward pass
  double direction = 0;  // backward pass
  double total = 0;
};

/// Feedback u = us_t - K_t (x (-) xs_t) of robots that are solved together. dx, u: indices of the robots' coordinates.
struct TaskGains {
  std::vector<int> dx, u;
  std::vector<Eigen::MatrixXd> K;  // one per node; no rows at impacts, and where another entry contains the robots
};

struct TaskSolution {  // The result of optimize, and a report of the solve.
  bool converged = false;
  double cost = 0;
  std::string reason;                     // why the solve stopped, with violated constraints, failures and remarks
  std::vector<std::string> remarks;       // remedies that were applied after a failure (see optimize)
  bool interrupted = false;               // whether TaskOptions::each ended the solve
  std::vector<TaskIteration> iterations;  // iterations of all solves, until the task's tolerance was met
  std::size_t polishing_iterations = 0;   // number of further iterations, until the KKT residual was small
  std::vector<Eigen::VectorXd> xs, us;    // nodes + 1 states, nodes controls
  std::vector<TaskGains> gains;           // one per decoupled subproblem or cluster; none if no direction was found
  std::string solver;
  std::string direction;            // method of search directions: "Riccati", or a name of lq::DirectionSolver
  std::vector<int> blocks;          // sizes of the matrices factorized at a node, one per subproblem or cluster
  double kkt_residual = 0;          // gradients are in units of the cost's Hessians (SolverDDP::get_kkt_scale)
  double constraint_violation = 0;  // largest over all nodes and rows
  std::vector<TaskViolation> violations;
  std::vector<TaskFailure> failures;         // dynamics that failed at the result, or in the last steps that were tried
  std::vector<Eigen::VectorXd> multipliers;  // multipliers of each node's [g; h]: a guess for TaskProblem::multipliers
  std::size_t outer_iterations = 0;          // minimisations of the augmented Lagrangian; 0 without constraints
  TaskTimes times;

  /// Returns whether the constraints were found to be infeasible.
  bool infeasible() const { return reason.rfind("infeasible", 0) == 0; }
};

struct TaskOptions {                      // Solver settings that are not in the file.
  std::optional<TaskSolver> solver = {};  // none: the solver that the task names
  int threads = 0;                        // number of threads; 0: OpenMP's number
  /// Called after each iteration. The solve ends if the call returns false.
  std::function<bool(const TaskIteration&)> each = {};
};

/// Solves a problem that make_problem made for the same solver, from the problem's initial guess, with the task's
/// iterations and tolerance. FDDP needs nodes of the whole scene; Box-FDDP accepts whole nodes or subproblems. kAuto
/// chooses the sparse solver if the problem has more than one block, else FDDP.
///
/// When the stopping value is below the tolerance, the solver continues until the KKT residual is below 1e-6. If both
/// thresholds are met, `converged` is true. The KKT residual is relative to the size of the cost
/// (SolverDDP::get_kkt_scale). For very large or small costs the tolerance is relative, too
/// (SolverDDP::set_measures_scale). With any of these solvers, SolverAugmentedLagrangian satisfies constraints to 1e-9.
///
/// A numerical failure is not an exception: `reason` describes the failure. `remarks` lists remedies that were applied:
///
/// - If search directions by blocks of coupled robots do not converge, their subproblem is solved as one dense block,
///   with as many iterations again. The problem then contains the nodes of this dense subproblem.
/// - If the gradient vanishes at the guess although costs decrease nearby, the solver starts from a nearby point.
///
/// Throws std::invalid_argument if the problem does not fit the task. Allocates. Thread-safe for distinct problems.
TaskSolution optimize(const TaskFile& task, TaskProblem& problem, const TaskOptions& options);

}  // namespace manycontact
