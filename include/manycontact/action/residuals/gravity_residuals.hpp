#pragma once
// Torques minus those that keep the scene at rest under gravity, external wrenches and springs. g(q) are the torques
// that compensate gravity, and tau_s(q) those of the external wrenches and springs at rest. Names and constructors are
// Crocoddyl's, which has no tau_s; nu is nv by default.

#include "manycontact/action/residual.hpp"

namespace manycontact {

/// The common base.
class GravityResidual : public ResidualModelAbstract {
 public:
  std::shared_ptr<ResidualDataAbstract> createData(DataCollector* shared) override;
  void lay_out(ResidualDataAbstract& data) const override;
  void calc(const std::shared_ptr<ResidualDataAbstract>& data, const ConstVectorRef& x,
            const ConstVectorRef& u) override;
  /// In a terminal node: tau_s(q) - g(q).
  void calc(const std::shared_ptr<ResidualDataAbstract>& data, const ConstVectorRef& x) override;
  void differentiate(const std::shared_ptr<ResidualDataAbstract>& data, const ConstVectorRef& x,
                     const ConstVectorRef& u) override;
  void differentiate(const std::shared_ptr<ResidualDataAbstract>& data, const ConstVectorRef& x) override;
  void print(std::ostream& os) const override;

 protected:
  /// Throws std::invalid_argument for a reference of a wrong size, or a frame that does not exist. nu: by default nv.
  GravityResidual(const char* name, std::shared_ptr<StateMultibody> state, std::size_t nu, bool contacts);
  const char* name_;
  bool contacts_;
};

/// The residual tau(x, u) - (g(q) - tau_s(q)) (nv) [N m, N].
class ResidualModelControlGrav : public GravityResidual {
 public:
  /// Throws std::invalid_argument for a reference of a wrong size, or a frame that does not exist. nu: by default nv.
  ResidualModelControlGrav(std::shared_ptr<StateMultibody> state, std::size_t nu);
  /// Throws std::invalid_argument for a reference of a wrong size, or a frame that does not exist. nu: by default nv.
  explicit ResidualModelControlGrav(std::shared_ptr<StateMultibody> state);
};

/// The residual tau(x, u) - (g(q) - tau_s(q) - J^T f(x, u)) (nv) [N m, N]. The Jacobians contain all derivatives of f
/// (Crocoddyl 3.0 lacks J^T df).
class ResidualModelContactControlGrav : public GravityResidual {
 public:
  /// Throws std::invalid_argument for a reference of a wrong size, or a frame that does not exist. nu: by default nv.
  ResidualModelContactControlGrav(std::shared_ptr<StateMultibody> state, std::size_t nu);
  /// Throws std::invalid_argument for a reference of a wrong size, or a frame that does not exist. nu: by default nv.
  explicit ResidualModelContactControlGrav(std::shared_ptr<StateMultibody> state);
};

}  // namespace manycontact
