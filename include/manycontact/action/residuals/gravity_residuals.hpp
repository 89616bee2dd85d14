#pragma once
// Residuals of torques: the torques at x, u minus those that keep the scene at rest under gravity, external wrenches
// and springs. The torques g(q) compensate gravity. External wrenches and springs exert the torques tau_s(q) at rest
// (not in Crocoddyl). Names and constructors are Crocoddyl's; nu is nv by default, and nu = 0 throws
// std::invalid_argument.

#include "manycontact/action/residual.hpp"

namespace manycontact {

/// The common base of both residuals.
class GravityResidual : public NamedResidual {
 public:
  std::shared_ptr<ResidualDataAbstract> createData(DataCollector* shared) override;
  void lay_out(ResidualDataAbstract& data) const override;
  using NamedResidual::calc;
  /// Computes the residual of a terminal node, tau_s(q) - g(q).
  void calc(const DataPtr& data, const ConstVectorRef& x) override;
  using NamedResidual::differentiate;
  void differentiate(const DataPtr& data, const ConstVectorRef& x) override;

 protected:
  /// contacts: whether contact forces contribute.
  GravityResidual(const char* name, std::shared_ptr<StateMultibody> state, std::size_t nu, bool contacts);
  bool contacts_;

 private:
  void evaluate(ResidualDataAbstract& data, const ConstVectorRef& x, const ConstVectorRef& u) const override;
  void fill_blocks(ResidualDataAbstract& data, const ConstVectorRef& x, const ConstVectorRef& u) const override;
};

/// The residual tau(x, u) - (g(q) - tau_s(q)) (nv) [N m, N].
class ResidualModelControlGrav : public GravityResidual {
 public:
  /// nu: number of controls.
  explicit ResidualModelControlGrav(std::shared_ptr<StateMultibody> state, std::size_t nu = kDefaultNu)
      : GravityResidual("ResidualModelControlGrav", std::move(state), nu, false) {}
};

/// The residual tau(x, u) - (g(q) - tau_s(q) - J^T f(x, u)) (nv) [N m, N]. The Jacobians contain all derivatives of f
/// (Crocoddyl 3.0 lacks J^T df).
class ResidualModelContactControlGrav : public GravityResidual {
 public:
  /// nu: number of controls.
  explicit ResidualModelContactControlGrav(std::shared_ptr<StateMultibody> state, std::size_t nu = kDefaultNu)
      : GravityResidual("ResidualModelContactControlGrav", std::move(state), nu, true) {}
};

}  // namespace manycontact
