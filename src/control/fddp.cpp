#include "manycontact/control/fddp.hpp"

namespace manycontact {

// What the gaps fs add to the expected improvement of DDP's, with V of the backward pass and the states tried x:
//     dv = - sum fs^T Vxx (xs (-) x),    d0 = dg + dv,    d1 = dq - 2 dv
const Eigen::Vector2d& SolverFDDP::expectedImprovement() {
  dv_ = 0;
  if (!is_feasible_) {
    const std::size_t T = problem_->get_T();
    for (std::size_t k = 0; k <= T; ++k) {
      const std::size_t t = k == 0 ? T : k - 1;  // the terminal node first, as in Crocoddyl
      problem_->model(t)->get_state()->diff(xs_try_[t], xs_[t], step_);
      dv_ -= Vxx_fs_[t].dot(step_);
    }
  }
  d_[0] = dg_ + dv_;
  d_[1] = dq_ - 2 * dv_;
  return d_;
}

//     dg = sum Qu^T k - sum Vx^T fs,    dq = - sum k^T Quu k + sum fs^T Vxx fs
void SolverFDDP::updateExpectedImprovement() {
  dg_ = dq_ = 0;
  const std::size_t T = problem_->get_T();
  const auto add_gap = [this](std::size_t t) {
    dg_ -= Vx_[t].dot(fs_[t]);
    dq_ += fs_[t].dot(Vxx_fs_[t]);
  };
  if (!is_feasible_) add_gap(T);
  for (std::size_t t = 0; t < T; ++t) {
    dg_ += Qu_[t].dot(k_[t]);
    dq_ -= k_[t].dot(Quuk_[t]);
    if (!is_feasible_) add_gap(t);
  }
}

bool SolverFDDP::accepts() const {
  if (dVexp_ >= 0) return std::abs(d_[0]) < th_grad_ * scale_ || dV_ > th_acceptstep_ * dVexp_;
  return !is_feasible_ && dV_ > th_acceptnegstep_ * dVexp_;  // the cost may rise while gaps close
}

void SolverFDDP::forwardPass(double steplength) {
  const bool gaps = !is_feasible_ && steplength != 1;
  rollOut(steplength, gaps, gaps);
}

void SolverFDDP::set_th_acceptnegstep(double th_acceptnegstep) {
  require(th_acceptnegstep >= 0, "SolverFDDP::set_th_acceptnegstep", "a number that is not negative is expected");
  th_acceptnegstep_ = th_acceptnegstep;
}

}  // namespace manycontact
