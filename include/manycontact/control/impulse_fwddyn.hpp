#pragma once
// An impact: the velocity jumps, the configuration does not change, and there are no controls.
//
//     [ M  J^T     ] [   v+    ]   [   M v   ]
//     [ J  -delta I] [ -Lambda ] = [ -e J v  ]        e = r_coeff, delta = JMinvJt_damping
//
// M is the mass matrix, J the Jacobian of the impulses, v and v+ the velocities before and after the impact, Lambda the
// impulses. The interface is that of Crocoddyl's ActionModelImpulseFwdDynamics. With w = v+ + e v the equations are
//
//     [ M  J^T     ] [    w    ]   [ (1 + e) M v ]
//     [ J  -delta I] [ -Lambda ] = [      0      ]
//
// These are the equations of contact forward dynamics at rest, without gravity. They are solved as such, also with
// redundant impulses.

#include "manycontact/action/contact_fwddyn.hpp"
#include "manycontact/action/impulse.hpp"
#include "manycontact/control/action_model.hpp"

namespace manycontact {

struct ActionDataImpulseFwdDynamics;
namespace internal {
class ImpactActuation;
}

/// A node with an impact. calc computes v+, impulses, costs and constraints. The data's report() has the status; a
/// failed solve gives NaN. As in Crocoddyl, a terminal node has the velocity jump too, but its residuals of impulses
/// are zero. calcDiff computes the derivatives at the x of the last calc. It throws std::logic_error unless the last
/// calc was of the same kind (with or without u), with the same active costs and constraints.
class ActionModelImpulseFwdDynamics
    : public NodeWithData<ActionModelImpulseFwdDynamics, ActionModelAbstract, ActionDataImpulseFwdDynamics> {
 public:
  static constexpr const char* kName = "ActionModelImpulseFwdDynamics";
  using Base = ActionModelAbstract;
  using Data = ActionDataImpulseFwdDynamics;
  using ConstraintModelManager = manycontact::ConstraintModelManager;
  using CostModelSum = manycontact::CostModelSum;
  using ImpulseModelMultiple = manycontact::ImpulseModelMultiple;
  using StateMultibody = manycontact::StateMultibody;

  /// costs and constraints have nu = 0. enable_force has no effect: derivatives of impulses are always computed. Throws
  /// std::invalid_argument if parts do not belong together, or r_coeff or damping are negative or not finite.
  ActionModelImpulseFwdDynamics(std::shared_ptr<StateMultibody> state, std::shared_ptr<ImpulseModelMultiple> impulses,
                                std::shared_ptr<CostModelSum> costs, double r_coeff = 0, double JMinvJt_damping = 0,
                                bool enable_force = false)
      : ActionModelImpulseFwdDynamics(state, impulses, costs, nullptr, r_coeff, JMinvJt_damping, enable_force) {}
  ActionModelImpulseFwdDynamics(std::shared_ptr<StateMultibody> state, std::shared_ptr<ImpulseModelMultiple> impulses,
                                std::shared_ptr<CostModelSum> costs,
                                std::shared_ptr<ConstraintModelManager> constraints, double r_coeff = 0,
                                double JMinvJt_damping = 0, bool enable_force = false);

  /// Throws std::invalid_argument for residuals of controls or accelerations, which an impact does not have.
  std::shared_ptr<ActionDataAbstract> createData() override;
  bool checkData(const DataPtr& data) override;
  void print(std::ostream& os) const override;

  const std::shared_ptr<ImpulseModelMultiple>& get_impulses() const { return impulses_; }          // the impulses
  const std::shared_ptr<CostModelSum>& get_costs() const { return costs_; }                        // the costs
  const std::shared_ptr<ConstraintModelManager>& get_constraints() const { return constraints_; }  // may be null
  const Multibody& get_pinocchio() const { return *multibody_->get_model(); }  // the robots; Crocoddyl's name
  const Multibody& get_model() const { return *multibody_->get_model(); }      // the robots
  /// Returns the armature (nv) [kg m^2, kg]. It replaces the armature of the robots' models, also in existing data.
  const Eigen::VectorXd& get_armature() const { return dynamics_->get_armature(); }
  void set_armature(const Eigen::VectorXd& armature);              // throws std::invalid_argument for a wrong size
  double get_restitution_coefficient() const { return r_coeff_; }  // the coefficient e
  void set_restitution_coefficient(double r_coeff);                // not negative, or std::invalid_argument is thrown
  double get_damping_factor() const { return dynamics_->get_damping_factor(); }  // JMinvJt_damping [1/kg]
  /// Sets JMinvJt_damping [1/kg]. Throws std::invalid_argument for a negative number.
  void set_damping_factor(double damping) { dynamics_->set_damping_factor(damping); }
  /// Returns the options of the solves, such as method and order, for data created afterwards.
  const Options& get_options() const { return dynamics_->get_options(); }
  void set_options(const Options& options) { dynamics_->set_options(options); }  // for data created afterwards

  std::size_t get_nr() const override { return costs_->get_nr(); }
  std::size_t get_ng() const override { return constraints_ ? constraints_->get_ng() : 0; }
  std::size_t get_nh() const override { return constraints_ ? constraints_->get_nh() : 0; }
  std::size_t get_ng_T() const override { return constraints_ ? constraints_->get_ng_T() : 0; }
  std::size_t get_nh_T() const override { return constraints_ ? constraints_->get_nh_T() : 0; }
  const Eigen::VectorXd& get_g_lb() const override { return constraints_ ? constraints_->get_lb() : g_lb_; }
  const Eigen::VectorXd& get_g_ub() const override { return constraints_ ? constraints_->get_ub() : g_ub_; }
  const Eigen::VectorXd& get_g_lb_T() const override { return constraints_ ? constraints_->get_lb_T() : g_lb_; }
  const Eigen::VectorXd& get_g_ub_T() const override { return constraints_ ? constraints_->get_ub_T() : g_ub_; }

 private:
  friend Data;
  void evaluate(Data& data, const ConstVectorRef& x, const ConstVectorRef* u) override;
  void differentiate(Data& data, const ConstVectorRef& x, const ConstVectorRef* u) override;
  void lay_out(Data& data) const;
  std::shared_ptr<StateMultibody> multibody_;
  std::shared_ptr<ImpulseModelMultiple> impulses_;
  std::shared_ptr<CostModelSum> costs_;
  std::shared_ptr<ConstraintModelManager> constraints_;
  std::shared_ptr<internal::ImpactActuation> actuation_;
  std::shared_ptr<DifferentialActionModelContactFwdDynamics> dynamics_;  // dynamics at rest, with u = v and xout = w
  double r_coeff_ = 0;
};

struct ActionDataImpulseFwdDynamics : ActionDataAbstract {  // Data of ActionModelImpulseFwdDynamics.
  explicit ActionDataImpulseFwdDynamics(ActionModelImpulseFwdDynamics* model);  // allocates the data of the model

  std::shared_ptr<DifferentialActionDataContactFwdDynamics> dynamics;
  DataCollector* multibody;  // collector of `dynamics`, in which the contacts are the impulses by name
  std::shared_ptr<CostDataSum> costs;
  std::shared_ptr<ConstraintDataManager> constraints;
  std::shared_ptr<DifferentialActionDataAbstract> terms;       // derivatives of costs and constraints
  const Report& report() const { return dynamics->report(); }  // status, rank and residuals of the last calc

  // Maintained by the model.
  internal::Stage stage = internal::Stage::kFresh;
  Eigen::VectorXd x_rest, v;       // [q; 0], and the velocity before the impact, at the last calc
  Eigen::VectorXd x;               // state of the last calc
  std::vector<bool> status;        // whether each cost, then each constraint, was active at the last calc
  std::vector<bool> laid_out;      // whether each impulse was active when the residuals' blocks were made
  std::vector<FrameIndex> frames;  // frame of each impulse when the residuals' blocks were made
};

}  // namespace manycontact
