#pragma once
// Residuals of state, control, torques and accelerations. Names and constructors are Crocoddyl's; nu is nv by default.
// References of a wrong size throw std::invalid_argument.

#include "manycontact/action/residual.hpp"

namespace manycontact {

/// The state error x (-) xref (2 nv).
class ResidualModelState : public ResidualWithReference<NamedResidual, Eigen::VectorXd> {
 public:
  /// xref: reference state (nx).
  ResidualModelState(std::shared_ptr<StateAbstract> state, const Eigen::VectorXd& xref, std::size_t nu = kDefaultNu);
  /// Uses xref = state->zero().
  explicit ResidualModelState(std::shared_ptr<StateAbstract> state, std::size_t nu = kDefaultNu);
  void lay_out(ResidualDataAbstract& data) const override;

 private:
  void evaluate(ResidualDataAbstract& data, const ConstVectorRef& x, const ConstVectorRef&) const override {
    state_->diff(reference_, x, data.r);
  }
  void fill_blocks(ResidualDataAbstract& data, const ConstVectorRef& x, const ConstVectorRef& u) const override;
};

/// The common base of residuals u - uref (nu).
class ControlResidual : public ResidualWithReference<NamedResidual, Eigen::VectorXd> {
 public:
  void lay_out(ResidualDataAbstract& data) const override;

 protected:
  /// Makes a residual with as many rows as controls.
  ControlResidual(const char* name, std::shared_ptr<StateAbstract> state, const Eigen::VectorXd& uref, std::size_t nu)
      : ResidualWithReference(uref, name, std::move(state), nu, nu, Dependence{.u = true}) {}

 private:
  void evaluate(ResidualDataAbstract& data, const ConstVectorRef&, const ConstVectorRef& u) const override {
    data.r = u - reference_;
  }
};

/// The control error u - uref (nu).
class ResidualModelControl : public ControlResidual {
 public:
  /// uref: reference controls; their number is nu.
  ResidualModelControl(std::shared_ptr<StateAbstract> state, const Eigen::VectorXd& uref)
      : ControlResidual("ResidualModelControl", std::move(state), uref, static_cast<std::size_t>(uref.size())) {}
  explicit ResidualModelControl(std::shared_ptr<StateAbstract> state, std::size_t nu = kDefaultNu);  // uses uref = 0
};

/// The error u - uref of joint efforts (nu). In forward dynamics, as in Crocoddyl, the efforts are the controls.
class ResidualModelJointEffort : public ControlResidual {
 public:
  /// nu must be the actuation's number of controls. fwddyn exists for Crocoddyl's signature and has no effect.
  ResidualModelJointEffort(std::shared_ptr<StateAbstract> state, std::shared_ptr<ActuationModelAbstract> actuation,
                           const Eigen::VectorXd& uref, std::size_t nu = kDefaultNu, bool fwddyn = false);
  /// Uses uref = 0.
  ResidualModelJointEffort(std::shared_ptr<StateAbstract> state, std::shared_ptr<ActuationModelAbstract> actuation,
                           std::size_t nu = kDefaultNu);
};

/// The acceleration error a - aref (nv) [m/s^2, rad/s^2].
class ResidualModelJointAcceleration : public ResidualWithReference<NamedResidual, Eigen::VectorXd> {
 public:
  /// aref: reference accelerations (nv).
  ResidualModelJointAcceleration(std::shared_ptr<StateAbstract> state, const Eigen::VectorXd& aref,
                                 std::size_t nu = kDefaultNu);
  /// Uses aref = 0.
  explicit ResidualModelJointAcceleration(std::shared_ptr<StateAbstract> state, std::size_t nu = kDefaultNu);
  void lay_out(ResidualDataAbstract& data) const override;

 private:
  void evaluate(ResidualDataAbstract& data, const ConstVectorRef& x, const ConstVectorRef& u) const override;
  void fill_blocks(ResidualDataAbstract& data, const ConstVectorRef& x, const ConstVectorRef& u) const override;
};

}  // namespace manycontact
