#pragma once
// SolverSparse: FDDP for problems whose nodes are ActionModelParts. The value functions of decoupled robots are
// independent, so that the Hessian Vxx, the step k and the feedback gain K are block diagonal, with subproblems i:
//
//     Vxx = diag(Vxx_1, Vxx_2, ...),    u_i = us_i - s k_i - K_i (x_i (-) xs_i).
//
// For N robots with n states and T nodes, backward passes cost N T n^3 operations; those of SolverFDDP cost T (N n)^3.
// Steps, regularisation and stopping use sums over the subproblems. Iterates equal those of SolverFDDP on the whole
// problem up to rounding errors; for one subproblem, bitwise. The problem's threads solve subproblems in parallel;
// results do not depend on their number. A subproblem with couplings uses another linear solver, and its gains differ.
//
// With limits the iterates are those of SolverBoxFDDP. Quu and the box are block diagonal, so the box QP of a node
// splits into one QP per subproblem. Each of these QPs is solved to the tolerance of the whole QP.

#include "manycontact/control/fddp.hpp"

namespace manycontact {

/// FDDP by subproblems. After the backward pass, get_Vx and get_k contain the whole problem's values; directions() has
/// the other results, per subproblem. Without limits only the Hessians (Vxx, Qxx, Qxu, Quu) of the current node are
/// stored, which halves the memory of a node.
class SolverSparse : public SolverFDDP {
 public:
  /// limits: whether controls stay within the models' limits. Throws std::invalid_argument if nodes have different
  /// subproblems (see `separate`), and for limits with nodes that have couplings but no dense matrices. With dense
  /// matrices, coupled subproblems become one dense subproblem, whose steps are those of SolverBoxFDDP. A problem
  /// without ActionModelParts has one subproblem.
  explicit SolverSparse(std::shared_ptr<ShootingProblem> problem, bool limits = false);

  /// Adapts the memory after nodes were replaced, as in a receding horizon. Subproblems with unchanged coordinates keep
  /// their memory; subproblems with couplings are set up again.
  void allocateData() override;

  /// Returns the number of controls of each subproblem, or of each cluster of a subproblem with couplings: the sizes of
  /// the matrices Quu that are factorized at a node.
  std::vector<int> blocks() const;
  /// Returns the method of search directions: "Riccati"; with couplings, the name of the lq::DirectionSolver.
  std::string direction() const;

 private:
  std::unique_ptr<Direction> direction_of(ShootingPart part) const;
  std::vector<std::shared_ptr<ActionDataAbstract>> nodes_;  // data from which the subproblems were made
  std::shared_ptr<ActionDataAbstract> terminal_;
};

}  // namespace manycontact
