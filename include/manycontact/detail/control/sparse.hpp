#pragma once
// FDDP for a problem whose nodes are ActionModelParts. The value functions of decoupled robots are independent, so that
// the direction and the feedback gains are block diagonal,
//
//     Vxx = diag(Vxx_1, Vxx_2, ...),    u_i = us_i - s k_i - K_i (x_i (-) xs_i).
//
// For N robots with n states the backward passes cost N T n^3, where SolverFDDP's costs T (N n)^3. Steps,
// regularisation and stopping use the sums over the subproblems. Up to rounding errors, iterates are those of
// SolverFDDP on the whole problem; for one subproblem they are bitwise equal. Subproblems are solved in parallel with
// the problem's threads; results do not depend on their number. A subproblem with couplings uses another linear solver,
// and its gains differ.
//
// With limits the iterates are those of SolverBoxFDDP: since Quu and the box are block diagonal, the box QP of a node
// splits into those of the subproblems. (Each is solved to the same tolerance as the whole.)

#include "manycontact/control/fddp.hpp"

namespace manycontact {

/// Results of the backward pass: get_Vx and get_k contain those of the whole problem; read the others from
/// directions(), per subproblem. Without limits only the Hessians (Vxx, Qxx, Qxu, Quu) of the current node are stored,
/// which halves the memory of a node.
class SolverSparse : public SolverFDDP {
 public:
  /// limits: controls stay within the models' limits. Throws std::invalid_argument if nodes have different subproblems
  /// (see `separate`), and for limits of nodes with couplings without dense matrices. (With dense matrices, coupled
  /// subproblems are one dense subproblem, whose steps are those of SolverBoxFDDP.) A problem without ActionModelParts
  /// has one subproblem.
  explicit SolverSparse(std::shared_ptr<ShootingProblem> problem, bool limits = false);

  /// Adapts the memory after nodes were replaced, as in a receding horizon. Subproblems with the same coordinates keep
  /// their memory; those with couplings are set up again.
  void allocateData() override;

  /// Number of controls of each subproblem, or of each cluster of a subproblem with couplings: the sizes of the
  /// matrices Quu that are factorized at a node.
  std::vector<int> blocks() const;
  /// The method of search directions: "Riccati", or for subproblems with couplings the name of lq::DirectionSolver.
  std::string direction() const;

 private:
  std::unique_ptr<Direction> direction_of(ShootingPart part) const;
  std::vector<std::shared_ptr<ActionDataAbstract>> nodes_;  // data from which the subproblems were made
  std::shared_ptr<ActionDataAbstract> terminal_;
};

}  // namespace manycontact
