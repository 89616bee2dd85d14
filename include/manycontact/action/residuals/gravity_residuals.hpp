#pragma once
// Torques beyond those that hold the scene still under gravity, pushes and springs: with g(q) the torques against
// gravity and tau_s(q) what the pushes and springs of the scene come to at rest. Names and constructors of Crocoddyl,
// which knows no tau_s; nu defaults to nv as there.

#include "manycontact/action/residual.hpp"

namespace manycontact {

class GravityResidual : public ResidualModelAbstract {
 public:
  std::shared_ptr<ResidualDataAbstract> createData(DataCollector* shared) override;
  void lay_out(ResidualDataAbstract& data) const override;
  void calc(const std::shared_ptr<ResidualDataAbstract>& data, const ConstVectorRef& x,
            const ConstVectorRef& u) override;
  /// Terminal: tau_s(q) - g(q).
  void calc(const std::shared_ptr<ResidualDataAbstract>& data, const ConstVectorRef& x) override;
  void differentiate(const std::shared_ptr<ResidualDataAbstract>& data, const ConstVectorRef& x,
                     const ConstVectorRef& u) override;
  void differentiate(const std::shared_ptr<ResidualDataAbstract>& data, const ConstVectorRef& x) override;
  void print(std::ostream& os) const override;

 protected:
  GravityResidual(const char* name, std::shared_ptr<StateMultibody> state, std::size_t nu, bool contacts);
  const char* name_;
  bool contacts_;
};

/// tau(x, u) - (g(q) - tau_s(q)) (nv).
class ResidualModelControlGrav : public GravityResidual {
 public:
  ResidualModelControlGrav(std::shared_ptr<StateMultibody> state, std::size_t nu);
  explicit ResidualModelControlGrav(std::shared_ptr<StateMultibody> state);
};

/// tau(x, u) - (g(q) - tau_s(q) - J^T f(x, u)) (nv). The Jacobians have all of f's derivatives (in Crocoddyl 3.0,
/// J^T df is missing).
class ResidualModelContactControlGrav : public GravityResidual {
 public:
  ResidualModelContactControlGrav(std::shared_ptr<StateMultibody> state, std::size_t nu);
  explicit ResidualModelContactControlGrav(std::shared_ptr<StateMultibody> state);
};

}  // namespace manycontact
