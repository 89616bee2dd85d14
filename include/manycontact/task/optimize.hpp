#pragma once
// A task solved, and what a solver did.

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "manycontact/control/kkt_residual.hpp"
#include "manycontact/task/violations.hpp"

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

/// Feedback of robots that are solved together, u = us_t - K_t (x (-) xs_t), of their coordinates of u and dx.
struct TaskGains {
  std::vector<int> dx, u;
  std::vector<Eigen::MatrixXd> K;  // by node; without rows at impacts, and where they are solved with others
};

struct TaskSolution {  // What optimize found, and how.
  bool converged = false;
  double cost = 0;
  std::string reason;  // why it stopped; of constraints that are missed, which and by how much; and the remarks
  std::vector<std::string> remarks;       // what was done where a solver's own rule failed
  bool interrupted = false;               // by TaskOptions::each
  std::vector<TaskIteration> iterations;  // until the task's tolerance
  std::size_t polishing_iterations = 0;   // after these, to the KKT residual
  std::vector<Eigen::VectorXd> xs, us;    // nodes + 1, nodes
  std::vector<TaskGains> gains;           // by part, or cluster of one; none where no direction was found
  std::string solver;
  std::string direction;    // how directions were found: "Riccati", or a name of lq::DirectionSolver
  std::vector<int> blocks;  // sizes of the matrices factorized at a node, one for each part or cluster
  double kkt_residual = 0;
  double constraint_violation = 0;  // largest over all nodes and rows
  std::vector<TaskViolation> violations;
  std::vector<Eigen::VectorXd> multipliers;  // of the constraints [g; h] of each node; for TaskProblem's, to go on
  std::size_t outer_iterations = 0;          // of the augmented Lagrangian, each a minimisation; 0 without constraints
  TaskTimes times;

  /// Whether constraints were found that cannot be met.
  bool infeasible() const { return reason.rfind("infeasible", 0) == 0; }
};

struct TaskOptions {                      // How to solve, where the file does not say it.
  std::optional<TaskSolver> solver = {};  // none: the task's
  int threads = 0;                        // 0: OpenMP's
  /// After each iteration; false ends the solve there.
  std::function<bool(const TaskIteration&)> each = {};
};

/// The problem is make_problem's for this solver: FDDP needs nodes of the whole scene, Box-FDDP takes these or parts.
/// kAuto: sparse where the problem has more than one block, else FDDP. From the problem's guess, with the task's
/// iterations and tolerance. Where the stopping value is below the tolerance it goes on until the KKT residual is below
/// 1e-6: both are what `converged` means, relative to the size of the costs where that is not an ordinary one
/// (SolverDDP::set_measures_scale). Constraints are met to 1e-9 by SolverAugmentedLagrangian around any of these
/// solvers. Numerical failure is no exception: `reason` says it, and what else was done:
///
/// * Robots that hold each other whose directions by blocks end without convergence: from there on by the dense
///   recursion of their part, with as many iterations again. The problem's nodes are then those of that part.
/// * A guess at which the gradient vanishes, though costs fall beside it: from beside it.
TaskSolution optimize(const TaskFile& task, TaskProblem& problem, const TaskOptions& options);

}  // namespace manycontact
