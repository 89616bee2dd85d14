#pragma once
// DDP and FDDP with the models' control limits (Tassa et al., ICRA 2014; Mastalli et al., Autonomous Robots 2022).
// BoxQP computes feed-forward terms, controls at a limit have no feedback, and the controls of steps are clamped. For
// candidates with gaps, limits are ignored. Interface and algorithm are those of Crocoddyl 3.0's SolverBoxDDP and
// SolverBoxFDDP.
//
// Crocoddyl's value function does not include how far clamped controls have to move. Therefore Crocoddyl may accept no
// step, and report convergence, although the cost is not minimal. Here a solve has converged only if the projected
// gradient and the curvature Quu predict a reduction below min(1e-9, th_stop). Otherwise the solve continues with
// `descend` until this is true. Before `descend`, the iterates are Crocoddyl's.

#include "manycontact/control/fddp.hpp"

namespace manycontact {

class SolverBoxDDP : public SolverDDP {  // DDP with limits on controls.
 public:
  /// Throws std::invalid_argument if `problem` is null.
  explicit SolverBoxDDP(std::shared_ptr<ShootingProblem> problem) : SolverDDP(std::move(problem), Limits::kKept) {}
  void forwardPass(double steplength) override;
  const std::vector<Eigen::MatrixXd>& get_Quu_inv() const;  // inverses of Quu on the free controls, per node
};

/// FDDP with limits on controls.
class SolverBoxFDDP : public SolverFDDP {
 public:
  /// Throws std::invalid_argument if `problem` is null.
  explicit SolverBoxFDDP(std::shared_ptr<ShootingProblem> problem) : SolverFDDP(std::move(problem), Limits::kKept) {}
  const std::vector<Eigen::MatrixXd>& get_Quu_inv() const;  // inverses of Quu on the free controls, per node
};

}  // namespace manycontact
