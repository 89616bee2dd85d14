#pragma once
// A unicycle with position x, y, heading theta, speed v, angular velocity omega: x = [x; y; theta], u = [v; omega],
//
//     x' = x + dt [v cos(theta); v sin(theta); omega],    l = 1/2 |wx x|^2 + 1/2 |wu u|^2.
//
// The interface is that of Crocoddyl's ActionModelUnicycle.

#include "manycontact/control/action_model.hpp"
#include "manycontact/detail/control/state_vector.hpp"

namespace manycontact {

/// A unicycle controlled by v and omega.
class ActionModelUnicycle : public NodeWithData<ActionModelUnicycle, ActionModelAbstract, ActionDataAbstract> {
 public:
  static constexpr const char* kName = "ActionModelUnicycle";
  ActionModelUnicycle() : NodeWithData(std::make_shared<StateVector>(3), 2, 5) {}
  using NodeWithData::calcDiff;
  /// Calls calcDiff(data, x), which a derived class may override, and computes the derivatives with respect to u.
  void calcDiff(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef& u) override;
  void print(std::ostream& os) const override { os << kName << " {dt=" << dt_ << "}"; }

  /// Returns the weights wx, wu; initially 10, 1.
  const Eigen::Vector2d& get_cost_weights() const { return weights_; }
  void set_cost_weights(const Eigen::Vector2d& weights) { weights_ = weights; }
  double get_dt() const { return dt_; }  // initially 0.1 s
  void set_dt(double dt);                // above 0, or std::invalid_argument is thrown

 private:
  void evaluate(ActionDataAbstract& data, const ConstVectorRef& x, const ConstVectorRef* u) override;
  void differentiate(ActionDataAbstract& data, const ConstVectorRef& x, const ConstVectorRef* u) override;
  Eigen::Vector2d weights_{10, 1};
  double dt_ = 0.1;
};

}  // namespace manycontact
