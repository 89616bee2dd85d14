#pragma once
// Residuals of state, control, torques and accelerations. Names and constructors are Crocoddyl's; nu is nv by default.

#include "manycontact/action/residual.hpp"

namespace manycontact {

/// The state error x (-) xref (2 nv).
class ResidualModelState : public ResidualModelAbstract {
 public:
  /// Throws std::invalid_argument for a reference of a wrong size, or a frame that does not exist. nu: by default nv.
  ResidualModelState(std::shared_ptr<StateAbstract> state, const Eigen::VectorXd& xref, std::size_t nu);
  /// Throws std::invalid_argument for a reference of a wrong size, or a frame that does not exist. nu: by default nv.
  ResidualModelState(std::shared_ptr<StateAbstract> state, const Eigen::VectorXd& xref);
  /// Uses xref = state->zero().
  ResidualModelState(std::shared_ptr<StateAbstract> state, std::size_t nu);
  /// Throws std::invalid_argument for a reference of a wrong size, or a frame that does not exist. nu: by default nv.
  explicit ResidualModelState(std::shared_ptr<StateAbstract> state);

  void calc(const std::shared_ptr<ResidualDataAbstract>& data, const ConstVectorRef& x,
            const ConstVectorRef& u) override;
  using ResidualModelAbstract::calc;
  void differentiate(const std::shared_ptr<ResidualDataAbstract>& data, const ConstVectorRef& x,
                     const ConstVectorRef& u) override;
  using ResidualModelAbstract::differentiate;
  void lay_out(ResidualDataAbstract& data) const override;
  void print(std::ostream& os) const override;

  const Eigen::VectorXd& get_reference() const { return xref_; }  // the reference of the residual or contact
  /// Sets the reference; a wrong size throws std::invalid_argument.
  void set_reference(const Eigen::VectorXd& reference);

 private:
  Eigen::VectorXd xref_;
};

/// The control error u - uref (nu).
class ResidualModelControl : public ResidualModelAbstract {
 public:
  /// Throws std::invalid_argument for a reference of a wrong size, or a frame that does not exist. nu: by default nv.
  ResidualModelControl(std::shared_ptr<StateAbstract> state, const Eigen::VectorXd& uref);
  /// Uses uref = 0.
  ResidualModelControl(std::shared_ptr<StateAbstract> state, std::size_t nu);
  /// Throws std::invalid_argument for a reference of a wrong size, or a frame that does not exist. nu: by default nv.
  explicit ResidualModelControl(std::shared_ptr<StateAbstract> state);

  void calc(const std::shared_ptr<ResidualDataAbstract>& data, const ConstVectorRef& x,
            const ConstVectorRef& u) override;
  using ResidualModelAbstract::calc;
  void differentiate(const std::shared_ptr<ResidualDataAbstract>& data, const ConstVectorRef& x,
                     const ConstVectorRef& u) override;
  using ResidualModelAbstract::differentiate;
  void lay_out(ResidualDataAbstract& data) const override;
  void print(std::ostream& os) const override;

  const Eigen::VectorXd& get_reference() const { return uref_; }  // the reference of the residual or contact
  /// Sets the reference; a wrong size throws std::invalid_argument.
  void set_reference(const Eigen::VectorXd& reference);

 private:
  Eigen::VectorXd uref_;
};

/// The error u - uref of joint efforts (nu). In forward dynamics, as in Crocoddyl, the efforts are the controls.
class ResidualModelJointEffort : public ResidualModelAbstract {
 public:
  /// nu must be that of the actuation. fwddyn exists for Crocoddyl's signature and has no effect.
  ResidualModelJointEffort(std::shared_ptr<StateAbstract> state, std::shared_ptr<ActuationModelAbstract> actuation,
                           const Eigen::VectorXd& uref, std::size_t nu, bool fwddyn = false);
  /// Throws std::invalid_argument for a reference of a wrong size, or a frame that does not exist. nu: by default nv.
  ResidualModelJointEffort(std::shared_ptr<StateAbstract> state, std::shared_ptr<ActuationModelAbstract> actuation,
                           const Eigen::VectorXd& uref);
  /// Uses uref = 0.
  ResidualModelJointEffort(std::shared_ptr<StateAbstract> state, std::shared_ptr<ActuationModelAbstract> actuation,
                           std::size_t nu);
  /// Throws std::invalid_argument for a reference of a wrong size, or a frame that does not exist. nu: by default nv.
  ResidualModelJointEffort(std::shared_ptr<StateAbstract> state, std::shared_ptr<ActuationModelAbstract> actuation);

  void calc(const std::shared_ptr<ResidualDataAbstract>& data, const ConstVectorRef& x,
            const ConstVectorRef& u) override;
  using ResidualModelAbstract::calc;
  void differentiate(const std::shared_ptr<ResidualDataAbstract>& data, const ConstVectorRef& x,
                     const ConstVectorRef& u) override;
  using ResidualModelAbstract::differentiate;
  void lay_out(ResidualDataAbstract& data) const override;
  void print(std::ostream& os) const override;

  const Eigen::VectorXd& get_reference() const { return uref_; }  // the reference of the residual or contact
  /// Sets the reference; a wrong size throws std::invalid_argument.
  void set_reference(const Eigen::VectorXd& reference);

 private:
  Eigen::VectorXd uref_;
};

/// The acceleration error a - aref (nv) [m/s^2, rad/s^2].
class ResidualModelJointAcceleration : public ResidualModelAbstract {
 public:
  /// Throws std::invalid_argument for a reference of a wrong size, or a frame that does not exist. nu: by default nv.
  ResidualModelJointAcceleration(std::shared_ptr<StateAbstract> state, const Eigen::VectorXd& aref, std::size_t nu);
  /// Throws std::invalid_argument for a reference of a wrong size, or a frame that does not exist. nu: by default nv.
  ResidualModelJointAcceleration(std::shared_ptr<StateAbstract> state, const Eigen::VectorXd& aref);
  /// Uses aref = 0.
  ResidualModelJointAcceleration(std::shared_ptr<StateAbstract> state, std::size_t nu);
  /// Throws std::invalid_argument for a reference of a wrong size, or a frame that does not exist. nu: by default nv.
  explicit ResidualModelJointAcceleration(std::shared_ptr<StateAbstract> state);

  void calc(const std::shared_ptr<ResidualDataAbstract>& data, const ConstVectorRef& x,
            const ConstVectorRef& u) override;
  using ResidualModelAbstract::calc;
  void differentiate(const std::shared_ptr<ResidualDataAbstract>& data, const ConstVectorRef& x,
                     const ConstVectorRef& u) override;
  using ResidualModelAbstract::differentiate;
  void lay_out(ResidualDataAbstract& data) const override;
  void print(std::ostream& os) const override;

  const Eigen::VectorXd& get_reference() const { return aref_; }  // the reference of the residual or contact
  /// Sets the reference; a wrong size throws std::invalid_argument.
  void set_reference(const Eigen::VectorXd& reference);

 private:
  Eigen::VectorXd aref_;
};

}  // namespace manycontact
