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

void ActionModelUnicycle::differentiate(ActionDataAbstract& d, const ConstVectorRef& x, const ConstVectorRef*) {
  const double w = weights_[0] * weights_[0];
  d.Fx.setIdentity();
  d.Lx = w * x;
  d.Lxx.diagonal().setConstant(w);
}

void ActionModelUnicycle::calcDiff(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef& u) {
  ActionDataAbstract& d = own("calcDiff", data, x, &u);
  calcDiff(data, x);
  const double c = std::cos(x[2]), s = std::sin(x[2]), w = weights_[1] * weights_[1];
  d.Fx(0, 2) = -dt_ * s * u[0];
  d.Fx(1, 2) = dt_ * c * u[0];
  d.Fu << dt_ * c, 0, dt_ * s, 0, 0, dt_;
  d.Lu = w * u;
  d.Luu.diagonal().setConstant(w);
}

}  // namespace manycontact
