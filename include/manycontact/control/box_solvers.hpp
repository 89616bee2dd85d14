#pragma once
// DDP and FDDP with the models' limits on controls: feed-forward terms by BoxQP, no feedback on controls at a limit,
// and steps clamped to the limits (Tassa et al., ICRA 2014; Mastalli et al., Autonomous Robots 2022). A candidate with
// gaps is treated as if there were no limits. Interface, algorithm and defaults of Crocoddyl 3.0's SolverBoxDDP and
// SolverBoxFDDP.
//
// Crocoddyl's rule leaves what clamped controls have yet to move out of the value function. So it may find no step, and
// call that converged, where the cost is above the least. Here a solve that ends so is converged only if the projected
// gradient g, with what Quu says of the curvature, leaves less than 1e-9 to gain (or th_stop, if that is less); else it
// continues by `descend` until that is so. Its iterates are Crocoddyl's until then.

#include "manycontact/control/fddp.hpp"

namespace manycontact {

class SolverBoxDDP : public SolverDDP {  // DDP with controls in a box
 public:
  explicit SolverBoxDDP(std::shared_ptr<ShootingProblem> problem) : SolverDDP(std::move(problem), Limits::kKept) {}
  void forwardPass(double steplength) override;
  const std::vector<Eigen::MatrixXd>& get_Quu_inv() const;
};

class SolverBoxFDDP : public SolverFDDP {
 public:
  explicit SolverBoxFDDP(std::shared_ptr<ShootingProblem> problem) : SolverFDDP(std::move(problem), Limits::kKept) {}
  const std::vector<Eigen::MatrixXd>& get_Quu_inv() const;
};

}  // namespace manycontact
