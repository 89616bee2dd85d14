#pragma once
// The backward pass of SolverDDP (ddp.hpp), on dense derivatives or on panels of IntegratedActionModelEuler. It takes
// half the operations for nodes of symplectic Euler (lq/riccati_step.hpp). BoxDirection solves a box QP per node.

#include "manycontact/control/box_qp.hpp"
#include "manycontact/control/direction.hpp"
#include "manycontact/lq/riccati_step.hpp"

namespace manycontact {

class RiccatiDirection : public Direction {
 public:
  using MatrixXdRowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

  /// keeps_values: whether to store Vxx, Qxx, Qxu, Quu of all nodes, which doubles a node's memory.
  RiccatiDirection(ShootingPart part, bool is_whole, bool keeps_values)
      : Direction(std::move(part), is_whole), keeps_values_(keeps_values) {}

  const char* name() const override { return "Riccati"; }
  std::vector<Gains> gains(std::size_t t) const override;

  /// Make the step of node t from the value function of node t + 1. compute_action_value_function must be called first,
  /// then compute_gains, then compute_value_function. In another order they throw std::invalid_argument.
  void compute_action_value_function(std::size_t t, const ActionModelAbstract& model, const ActionDataAbstract& data);
  virtual bool compute_gains(std::size_t t);  // returns false if Quu is not positive definite
  void compute_value_function(std::size_t t);

  const std::vector<Eigen::MatrixXd>& get_Vxx() const { return Vxx_; }
  const std::vector<Eigen::MatrixXd>& get_Qxx() const { return Qxx_; }
  const std::vector<Eigen::MatrixXd>& get_Qxu() const { return Qxu_; }
  const std::vector<Eigen::MatrixXd>& get_Quu() const { return Quu_; }
  const Vectors& get_Qx() const { return Qx_; }
  const Vectors& get_Qu() const { return Qu_; }
  const std::vector<MatrixXdRowMajor>& get_K() const { return K_; }

  void resize() override;
  bool compute(double preg, double dreg) override;
  Eigen::Vector2d improvement(bool gaps) override;
  double gap_improvement() override;
  double expected_reduction() const override;
  void feed_forward_gradient(Vectors& g) override;
  void precondition_feed_forward(Vectors& g) override;

 protected:
  void step_control(std::size_t t, double steplength) override;
  virtual void limit_control(std::size_t) {}  // clamps us_try[t] to the limits
  /// Records the controls of node t at limits that a descent would exceed, and sets their gradient entries to zero.
  virtual void hold_controls(std::size_t, Eigen::VectorXd&) {}

  std::vector<Eigen::MatrixXd> Qxu_, Quu_, L_;  // one entry per running node; L_: Cholesky factors of Quu
  Vectors Qx_, Qu_;                             // one entry per running node
  std::vector<MatrixXdRowMajor> K_;             // one entry per running node

 private:
  Eigen::MatrixXd& value(std::size_t t) { return keeps_values_ ? Vxx_[t] : two_values_[t % 2]; }
  void add_gap(std::size_t t);
  void add_hessians(const ActionDataAbstract& data);
  const lq::SymplecticStructure* set_dynamics(const ActionModelAbstract& model, const ActionDataAbstract& data);
  bool keeps_values_;
  double preg_ = 0;
  std::vector<Eigen::MatrixXd> Vxx_, Qxx_;  // Vxx_ per node (T + 1), Qxx_ per running node (T)
  Eigen::MatrixXd two_values_[2];           // Vxx of nodes t and t + 1, if keeps_values_ is false
  Vectors Vxx_fs_, Quuk_;                   // Vxx fs per node, if the candidate has gaps fs; Quu k per running node
  lq::RiccatiStep riccati_;
  lq::SymplecticStructure steps_;
  static constexpr std::size_t kNoNode = static_cast<std::size_t>(-1);
  std::size_t node_ = kNoNode;  // node whose Hessians are in riccati_
};

class BoxDirection : public RiccatiDirection {  // A direction within the models' control limits.
 public:
  BoxDirection(ShootingPart part, bool is_whole)
      : RiccatiDirection(std::move(part), is_whole, true), qp_(part_.problem->model(0)->get_nu(), 100, 0.1, 1e-5, 0) {}

  bool compute_gains(std::size_t t) override;
  const std::vector<Eigen::MatrixXd>& get_Quu_inv() const { return Quu_inv_; }

  void resize() override;
  void precondition_feed_forward(Vectors& g) override;
  void hold_feed_forward(Vectors& nu) override;
  void set_scale(double scale) override { qp_.set_th_grad(1e-5 * scale); }

 protected:
  void limit_control(std::size_t t) override;
  void hold_controls(std::size_t t, Eigen::VectorXd& g) override;

 private:
  BoxQP qp_;
  std::vector<Eigen::MatrixXd> Quu_inv_;
  Eigen::VectorXd du_lb_, du_ub_;        // bounds of du at the current node
  std::vector<std::vector<bool>> held_;  // flags of each node's controls at a limit in the last gradient
};

}  // namespace manycontact
