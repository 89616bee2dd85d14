#pragma once
// A differential action model integrated over one time step h, with the interface of Crocoddyl's
// IntegratedActionModelAbstract. The cost is h times the differential model's cost (Runge-Kutta: a weighted sum over
// stages), in a terminal node without the factor h. Constraints are evaluated at the beginning of the step.

#include "manycontact/control/action_model.hpp"
#include "manycontact/control/control_parametrization.hpp"

namespace manycontact {

/// The data of the differential model and of the controls at one stage of a step.
struct IntegratorStage {
  const std::shared_ptr<DifferentialActionDataAbstract>& differential;
  const std::shared_ptr<ControlParametrizationDataAbstract>& control;
};

/// The common base of the data of integrators.
struct IntegratedActionDataAbstract : ActionDataAbstract {
  using ActionDataAbstract::ActionDataAbstract;
  virtual std::size_t stages() const { return 1; }         // number of stages of a step
  virtual IntegratorStage stage(std::size_t i) const = 0;  // the data of one stage
  Eigen::VectorXd dx;                                      // ndx: the step, set by calc
};

class IntegratedActionModelAbstract : public ActionModelAbstract {  // A differential model integrated over one step.
 public:
  using DifferentialActionModelAbstract = manycontact::DifferentialActionModelAbstract;
  using ControlParametrizationModelAbstract = manycontact::ControlParametrizationModelAbstract;

  /// time_step: step in s. with_cost_residual: whether data->r contains the residuals of the costs. Throws
  /// std::invalid_argument if the step is negative or not finite (Crocoddyl uses 1e-3 then), and if the control's nw is
  /// not the model's nu.
  IntegratedActionModelAbstract(std::shared_ptr<DifferentialActionModelAbstract> model,
                                std::shared_ptr<ControlParametrizationModelAbstract> control, double time_step = 1e-3,
                                bool with_cost_residual = true);
  explicit IntegratedActionModelAbstract(std::shared_ptr<DifferentialActionModelAbstract> model,
                                         double time_step = 1e-3, bool with_cost_residual = true);

  void set_g_lb(const Eigen::VectorXd& g_lb) override { differential_->set_g_lb(g_lb); }
  void set_g_ub(const Eigen::VectorXd& g_ub) override { differential_->set_g_ub(g_ub); }
  /// Returns the model in continuous time.
  const std::shared_ptr<DifferentialActionModelAbstract>& get_differential() const { return differential_; }
  /// Returns the parametrization of the controls.
  const std::shared_ptr<ControlParametrizationModelAbstract>& get_control() const { return control_; }
  double get_dt() const { return time_step_; }  // the step [s]
  void set_dt(double dt);                       // throws std::invalid_argument if it is negative or not finite [s]
  virtual double get_weight(std::size_t) const { return 1; }  // weight of the stage's cost, in units of the step
  bool checkData(const DataPtr& data) override;
  void quasiStatic(const DataPtr& data, VectorRef u, const ConstVectorRef& x, std::size_t maxiter = 100,
                   double tol = 1e-9) override;

 protected:
  const NodeAbstract* sized_by() const override { return differential_.get(); }
  /// Prints the model under the given name.
  void print_as(const char* name, std::ostream& os) const {
    os << name << " {dt=" << time_step_ << ", " << *differential_ << "}";
  }

  /// Compute the results of calc and calcDiff in a terminal node.
  void calc_terminal(const ConstVectorRef& x, IntegratedActionDataAbstract& data) const;
  void calcDiff_terminal(const ConstVectorRef& x, IntegratedActionDataAbstract& data) const;

  std::shared_ptr<DifferentialActionModelAbstract> differential_;
  std::shared_ptr<ControlParametrizationModelAbstract> control_;
  double time_step_, time_step2_;  // h, h^2
  bool with_cost_residual_;
};

}  // namespace manycontact
