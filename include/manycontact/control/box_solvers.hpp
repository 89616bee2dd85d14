#pragma once
// DDP and FDDP with the models' limits on controls: feed-forward terms by BoxQP, no feedback on controls at a limit,
// and steps clamped to the limits (Tassa et al., ICRA 2014; Mastalli et al., Autonomous Robots 2022). A candidate with
// gaps is treated as if there were no limits. Interface, algorithm and defaults of Crocoddyl 3.0's SolverBoxDDP and
// SolverBoxFDDP.

#include "manycontact/control/box_qp.hpp"
#include "manycontact/control/fddp.hpp"

namespace manycontact {

/// What the two have in common.
template <class Base>
class SolverWithBox : public Base {
 public:
  explicit SolverWithBox(typename Base::Source source);
  void allocateData() override;
  void computeGains(std::size_t t) override;
  bool keeps_limits() const override { return true; }
  const std::vector<Eigen::MatrixXd>& get_Quu_inv() const { return Quu_inv_; }

 protected:
  void limitControl(std::size_t t) override;
  void adoptScale() override { qp_.set_th_grad(1e-5 * this->scale_); }
  void preconditionFeedForward(std::vector<Eigen::VectorXd>& g) override;
  void holdFeedForward(std::vector<Eigen::VectorXd>& nu) override;
  void holdControls(std::size_t t, Eigen::VectorXd& g) override;
  BoxQP qp_;
  std::vector<Eigen::MatrixXd> Quu_inv_;
  Eigen::VectorXd du_lb_, du_ub_;        // of the node at hand
  std::vector<std::vector<bool>> held_;  // controls at limits, of the last feed-forward gradient
};

class SolverBoxDDP : public SolverWithBox<SolverDDP> {  // DDP with controls in a box
 public:
  using SolverWithBox::SolverWithBox;
  void forwardPass(double steplength) override;
};

class SolverBoxFDDP : public SolverWithBox<SolverFDDP> {
 public:
  using SolverWithBox::SolverWithBox;
};

extern template class SolverWithBox<SolverDDP>;
extern template class SolverWithBox<SolverFDDP>;

}  // namespace manycontact
