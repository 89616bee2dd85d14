#pragma once
// DDP and FDDP with the models' limits on controls: BoxQP computes feed-forward terms, controls at a limit have no
// feedback, and steps are clamped (Tassa et al., ICRA 2014; Mastalli et al., Autonomous Robots 2022). For a candidate
// with gaps limits are ignored. Interface, algorithm, defaults: Crocoddyl 3.0's SolverBoxDDP and SolverBoxFDDP.
//
// Crocoddyl's rule leaves out of the value function how far clamped controls have to move. It may therefore find no
// step, and report convergence, although the cost is not minimal. Here such a solve has converged only if the projected
// gradient, with the curvature Quu, promises a gain of less than 1e-9 (or th_stop, if that is less). Otherwise it
// continues with `descend` until this is so. Before that, its iterates are Crocoddyl's.

#include "manycontact/control/fddp.hpp"

namespace manycontact {

class SolverBoxDDP : public SolverDDP {  // DDP with limits on controls.
 public:
  /// problem: not null.
  explicit SolverBoxDDP(std::shared_ptr<ShootingProblem> problem) : SolverDDP(std::move(problem), Limits::kKept) {}
  void forwardPass(double steplength) override;
  const std::vector<Eigen::MatrixXd>& get_Quu_inv() const;  // inverses of Quu on the free controls, per node
};

/// FDDP with limits on controls.
class SolverBoxFDDP : public SolverFDDP {
 public:
  /// problem: not null.
  explicit SolverBoxFDDP(std::shared_ptr<ShootingProblem> problem) : SolverFDDP(std::move(problem), Limits::kKept) {}
  const std::vector<Eigen::MatrixXd>& get_Quu_inv() const;  // inverses of Quu on the free controls, per node
};

}  // namespace manycontact
