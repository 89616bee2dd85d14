#pragma once
// Solves a task, and reports what the solver did.

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "manycontact/control/kkt_residual.hpp"
#include "manycontact/task/violations.hpp"

namespace manycontact {

/// The values that a solver's callback receives after an iteration; gaps are those before it. The cost is the task's
/// own. With constraints, the other values are those of the augmented Lagrangian.
struct TaskIteration {
  double cost = 0, stop = 0, regularisation = 0, step_length = 0, gaps = 0;
  bool feasible = false;
};

/// Times per running node, medians over the iterations [us]; total [us].
struct TaskTimes {
  double calc = 0;       // forward pass: controls, dynamics and costs
  double calc_diff = 0;  // derivatives of the forward pass
  double direction = 0;  // backward pass
  double total = 0;
};

/// Feedback u = us_t - K_t (x (-) xs_t) of robots that are solved together. dx and u are their coordinates.
struct TaskGains {
  std::vector<int> dx, u;
  std::vector<Eigen::MatrixXd> K;  // one per node; no rows at impacts, and where the robots are solved with others
};

struct TaskSolution {  // The result of optimize, and how it was found.
  bool converged = false;
  double cost = 0;
  std::string reason;                     // why the solve stopped, with violated constraints, failures and remarks
  std::vector<std::string> remarks;       // fallbacks taken where a solver's own rule failed
  bool interrupted = false;               // whether TaskOptions::each ended the solve
  std::vector<TaskIteration> iterations;  // up to the task's tolerance; of all solvers that were tried
  std::size_t polishing_iterations = 0;   // further iterations, up to the KKT residual
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

  /// Whether the constraints were found to be infeasible.
  bool infeasible() const { return reason.rfind("infeasible", 0) == 0; }
};

struct TaskOptions {                      // Solver settings that are not in the file.
  std::optional<TaskSolver> solver = {};  // none: that of the task
  int threads = 0;                        // 0: as many as OpenMP offers
  /// Called after each iteration; if it returns false, the solve ends.
  std::function<bool(const TaskIteration&)> each = {};
};

/// Solves a problem that make_problem made for the same solver, from the problem's initial guess, with the task's
/// iterations and tolerance. FDDP needs nodes of the whole scene; Box-FDDP accepts these or subproblems. kAuto chooses
/// sparse if the problem has more than one block, else FDDP.
///
/// When the stopping value is below the tolerance, the solver continues until the KKT residual is below 1e-6;
/// `converged` means both. The KKT residual is relative to the size of the cost (SolverDDP::get_kkt_scale), and for
/// costs of extraordinary size so is the tolerance (SolverDDP::set_measures_scale).
/// Constraints are met to 1e-9 by SolverAugmentedLagrangian with any of these solvers.
///
/// A numerical failure is not an exception. `reason` describes it, and these remedies, if they were applied:
///
/// - If block-wise search directions of coupled robots do not converge, a dense recursion of their subproblem replaces
///   them, with as many iterations again. The problem's nodes are then those of that subproblem.
/// - If the gradient vanishes at the guess although costs decrease nearby, the solver starts from a nearby point.
///
/// Throws std::invalid_argument if the problem does not fit the task. Allocates. Thread-safe for distinct problems.
TaskSolution optimize(const TaskFile& task, TaskProblem& problem, const TaskOptions& options);

}  // namespace manycontact
