#pragma once
// FDDP on a problem whose nodes are ActionModelParts: robots that never meet have value functions of their own, so that
// the direction and the feedback gains are block diagonal,
//
//     Vxx = diag(Vxx_1, Vxx_2, ...),    u_i = us_i - s k_i - K_i (x_i (-) xs_i),
//
// at the cost of each part's backward pass: N T n^3 for N robots of n states, where SolverFDDP's is T (N n)^3. Steps,
// regularisation and stopping are those of the sums over the parts: iterates are SolverFDDP's on the whole problem, but
// for rounding; of one part they are the same bits. Parts are worked on in parallel, over the problem's threads; the
// numbers do not depend on how many. A part whose nodes have couplings takes its directions by
// control/coupled_direction.hpp, where gains differ.
//
// With limits the iterates are SolverBoxFDDP's: the box QP of a node is that of each part's controls, since Quu and the
// box are. (Each is solved to the tolerance that the whole is.)

#include "manycontact/control/fddp.hpp"

namespace manycontact {

/// Of what SolverDDP holds of the backward pass, get_Vx and get_k are the whole's; of the others directions() have each
/// part's. Without limits the Hessians (Vxx, Qxx, Qxu, Quu) are empty: of them only the node at hand's are kept, which
/// halves a node's memory.
class SolverSparse : public SolverFDDP {
 public:
  /// limits: controls stay within the models'. Throws std::invalid_argument where nodes differ in their parts (see
  /// `separate`), and for limits of nodes with couplings without dense matrices (with them, parts that hold each other
  /// are one dense part, whose steps are SolverBoxFDDP's). A problem without ActionModelParts is one part.
  explicit SolverSparse(std::shared_ptr<ShootingProblem> problem, bool limits = false);

  /// Where nodes were replaced, as in a receding horizon, parts of the same coordinates follow with their memory; those
  /// that are joined by couplings are made anew.
  void allocateData() override;

  /// Controls of each part (of one joined by couplings, of each cluster of it): the sizes of the matrices Quu that are
  /// factorized at a node.
  std::vector<int> blocks() const;
  /// How directions are found: "Riccati", or of parts that are joined by couplings lq::DirectionSolver's name.
  std::string direction() const;

 private:
  std::unique_ptr<Direction> direction_of(ShootingPart part) const;
  std::vector<std::shared_ptr<ActionDataAbstract>> nodes_;  // that the parts were made of
  std::shared_ptr<ActionDataAbstract> terminal_;
};

}  // namespace manycontact
