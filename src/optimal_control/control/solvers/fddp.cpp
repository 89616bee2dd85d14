#include "manycontact/control/box_solvers.hpp"
#include "manycontact/control/riccati_direction.hpp"

namespace manycontact {

// Adds the terms of the gaps fs to DDP's expected improvement, with tried states x and the last backward pass's Vxx:
//     dv = - sum fs^T Vxx (xs (-) x),    d0 = dg + dv,    d1 = dq - 2 dv
const Eigen::Vector2d& SolverFDDP::expectedImprovement() {
  dv_ = 0;
  for (const auto& own : directions_) dv_ += own->gap_improvement();
  d_[0] = dg_ + dv_;
  d_[1] = dq_ - 2 * dv_;
  return d_;
}

// Computes dg = sum Qu^T k - sum Vx^T fs,    dq = - sum k^T Quu k + sum fs^T Vxx fs
void SolverFDDP::updateExpectedImprovement() {
  const Eigen::Vector2d d = improvement(true);
  dg_ = d[0];
  dq_ = d[1];
}

bool SolverFDDP::accepts() const {
  if (dVexp_ >= 0) return std::abs(d_[0]) < th_grad_ * scale_ || dV_ > th_acceptstep_ * dVexp_;
  return !is_feasible_ && dV_ > th_acceptnegstep_ * dVexp_;  // the cost may increase while gaps close
}

void SolverFDDP::forwardPass(double steplength) {
  const bool gaps = !is_feasible_ && steplength != 1;
  rollOut(steplength, gaps, gaps);
}

// Makes a step that multiplies the terminal gap by 1 - steplength, as in Crocoddyl. All other gaps are closed.
void SolverBoxDDP::forwardPass(double steplength) { rollOut(steplength, false, !is_feasible_ && steplength != 1); }

const std::vector<Eigen::MatrixXd>& SolverBoxDDP::get_Quu_inv() const {
  return static_cast<const BoxDirection&>(*directions_[0]).get_Quu_inv();
}
const std::vector<Eigen::MatrixXd>& SolverBoxFDDP::get_Quu_inv() const {
  return static_cast<const BoxDirection&>(*directions_[0]).get_Quu_inv();
}

}  // namespace manycontact
