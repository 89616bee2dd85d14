#pragma once
// A wheel in the plane, x = [x; y; theta], u = [v; omega]:
//
//     x' = x + dt [v cos(theta); v sin(theta); omega],    l = 1/2 |wx x|^2 + 1/2 |wu u|^2.
//
// Crocoddyl's ActionModelUnicycle.

#include "manycontact/control/action_model.hpp"
#include "manycontact/control/state_vector.hpp"

namespace manycontact {

class ActionModelUnicycle : public ActionModelAbstract {  // A unicycle controlled by v and omega.
 public:
  ActionModelUnicycle();

  void calc(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef& u) override;
  void calc(const DataPtr& data, const ConstVectorRef& x) override;
  void calcDiff(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef& u) override;
  void calcDiff(const DataPtr& data, const ConstVectorRef& x) override;
  void print(std::ostream& os) const override;

  /// The weights wx, wu; initially 10, 1.
  const Eigen::Vector2d& get_cost_weights() const { return weights_; }
  void set_cost_weights(const Eigen::Vector2d& weights) { weights_ = weights; }
  double get_dt() const { return dt_; }  // initially 0.1 s
  void set_dt(double dt);                // above 0, or std::invalid_argument is thrown

 private:
  Eigen::Vector2d weights_{10, 1};
  double dt_ = 0.1;
};

}  // namespace manycontact
