#pragma once
// Explicit Runge-Kutta methods with two, three (Heun's) and four stages y_i, step h, accelerations a, cost l: y_0 = x,
//
//     y_i = x (+) c_i h k_(i-1),    k_i = [v(y_i); a(y_i, w(c_i))],
//     x'  = x (+) h sum_i b_i k_i,  cost = h sum_i b_i l(y_i, w(c_i))
//
//     two:   c = 0, 1/2            b = 0, 1
//     three: c = 0, 1/3, 2/3       b = 1/4, 0, 3/4
//     four:  c = 0, 1/2, 1/2, 1    b = 1/6, 1/3, 1/3, 1/6
//
// The interface is that of Crocoddyl's IntegratedActionModelRK. Hessians are those of Gauss-Newton, without second
// derivatives of y_i.

#include "manycontact/control/integrated_action.hpp"

namespace manycontact {

struct IntegratedActionDataRK;

/// A differential model integrated with 2, 3 or 4 stages.
class IntegratedActionModelRK
    : public NodeWithData<IntegratedActionModelRK, IntegratedActionModelAbstract, IntegratedActionDataRK> {
 public:
  static constexpr const char* kName = "IntegratedActionModelRK";  // for messages

  /// Throws std::invalid_argument for null pointers and numbers out of range.
  IntegratedActionModelRK(std::shared_ptr<DifferentialActionModelAbstract> model,
                          std::shared_ptr<ControlParametrizationModelAbstract> control, RKType rktype,
                          double time_step = 1e-3, bool with_cost_residual = true);
  IntegratedActionModelRK(std::shared_ptr<DifferentialActionModelAbstract> model, RKType rktype,
                          double time_step = 1e-3, bool with_cost_residual = true);  // with constant controls

  bool checkData(const DataPtr& data) override;
  void print(std::ostream& os) const override { print_as(kName, os); }
  std::size_t get_ni() const { return c_.size(); }               // number of stages
  const std::vector<double>& get_weights() const { return b_; }  // weights of the stages, in step and cost
  double get_weight(std::size_t i) const override { return b_[i]; }

 private:
  void evaluate(IntegratedActionDataRK& data, const ConstVectorRef& x, const ConstVectorRef* u) override;
  void differentiate(IntegratedActionDataRK& data, const ConstVectorRef& x, const ConstVectorRef* u) override;
  std::vector<double> c_, b_;
};

struct IntegratedActionDataRK : IntegratedActionDataAbstract {      // Data of IntegratedActionModelRK.
  explicit IntegratedActionDataRK(IntegratedActionModelRK* model);  // allocates the data of the model
  std::size_t stages() const override { return differential.size(); }
  IntegratorStage stage(std::size_t i) const override { return {differential[i], control[i]}; }

  // These members have one entry per stage.
  std::vector<std::shared_ptr<DifferentialActionDataAbstract>> differential;
  std::vector<std::shared_ptr<ControlParametrizationDataAbstract>> control;
  std::vector<double> integral;                 // cost of each stage
  std::vector<Eigen::VectorXd> ki, y, ws;       // k_i (ndx), y_i (nx), controls w(c_i) (nw)
  std::vector<Eigen::VectorXd> dx_rk;           // ndx: y_i = x (+) dx_rk_i
  std::vector<Eigen::MatrixXd> dki_dx, dki_du;  // ndx x ndx, ndx x nu: set by calcDiff
  std::vector<Eigen::MatrixXd> dyi_dx, dyi_du;  // ndx x ndx, ndx x nu: set by calcDiff

  // Workspace of calcDiff for one stage, in the order of the members: l_xx y_x, l_xx y_u + l_xw w_u, l_ww w_u, w_u^T
  // l_ww w_u, and w_u^T l_w. Indices denote derivatives.
  Eigen::MatrixXd Lxx_dx, Lxu_i, Lwu, Luu_i;
  Eigen::VectorXd Lu_i;
};

}  // namespace manycontact
