#include "manycontact/control/unicycle.hpp"

#include <cmath>

namespace manycontact {

void ActionModelUnicycle::set_dt(double dt) {
  require(dt > 0 && std::isfinite(dt), "ActionModelUnicycle::set_dt", "a positive number is expected");
  dt_ = dt;
}

void ActionModelUnicycle::evaluate(ActionDataAbstract& d, const ConstVectorRef& x, const ConstVectorRef* u) {
  d.xnext = x;
  d.r.head<3>() = weights_[0] * x;
  d.r.tail<2>().setZero();
  if (u) {
    d.xnext = x + dt_ * Eigen::Vector3d(std::cos(x[2]) * (*u)[0], std::sin(x[2]) * (*u)[0], (*u)[1]);
    d.r.tail<2>() = weights_[1] * *u;
  }
  d.cost = 0.5 * d.r.squaredNorm();
}

void ActionModelUnicycle::differentiate(ActionDataAbstract& d, const ConstVectorRef& x, const ConstVectorRef* u) {
  const double of_x = weights_[0] * weights_[0], of_u = weights_[1] * weights_[1];
  d.Fx.setIdentity();
  d.Lx = of_x * x;
  d.Lxx.diagonal().setConstant(of_x);
  if (!u) return;
  const double c = std::cos(x[2]), s = std::sin(x[2]);
  d.Fx(0, 2) = -dt_ * s * (*u)[0];
  d.Fx(1, 2) = dt_ * c * (*u)[0];
  d.Fu << dt_ * c, 0, dt_ * s, 0, 0, dt_;
  d.Lu = of_u * *u;
  d.Luu.diagonal().setConstant(of_u);
}

}  // namespace manycontact
