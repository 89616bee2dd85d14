#include "manycontact/control/unicycle.hpp"

#include <cmath>
#include <ostream>

namespace manycontact {

using DataPtr = std::shared_ptr<ActionDataAbstract>;

ActionModelUnicycle::ActionModelUnicycle() : ActionModelAbstract(std::make_shared<StateVector>(3), 2, 5) {}

void ActionModelUnicycle::set_dt(double dt) {
  require(dt > 0 && std::isfinite(dt), "ActionModelUnicycle::set_dt", "a positive number is expected");
  dt_ = dt;
}

void ActionModelUnicycle::calc(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef& u) {
  check("ActionModelUnicycle::calc", x, u);
  ActionDataAbstract& d = check_data("ActionModelUnicycle::calc", data);
  d.xnext = x + dt_ * Eigen::Vector3d(std::cos(x[2]) * u[0], std::sin(x[2]) * u[0], u[1]);
  d.r.head<3>() = weights_[0] * x;
  d.r.tail<2>() = weights_[1] * u;
  d.cost = 0.5 * d.r.squaredNorm();
}

void ActionModelUnicycle::calc(const DataPtr& data, const ConstVectorRef& x) {
  check("ActionModelUnicycle::calc", x);
  ActionDataAbstract& d = check_data("ActionModelUnicycle::calc", data);
  d.xnext = x;
  d.r.head<3>() = weights_[0] * x;
  d.r.tail<2>().setZero();
  d.cost = 0.5 * d.r.squaredNorm();
}

void ActionModelUnicycle::calcDiff(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef& u) {
  check("ActionModelUnicycle::calcDiff", x, u);
  calcDiff(data, x);
  const double c = std::cos(x[2]), s = std::sin(x[2]), w = weights_[1] * weights_[1];
  data->Fx(0, 2) = -dt_ * s * u[0];
  data->Fx(1, 2) = dt_ * c * u[0];
  data->Fu << dt_ * c, 0, dt_ * s, 0, 0, dt_;
  data->Lu = w * u;
  data->Luu.diagonal().setConstant(w);
}

void ActionModelUnicycle::calcDiff(const DataPtr& data, const ConstVectorRef& x) {
  check("ActionModelUnicycle::calcDiff", x);
  ActionDataAbstract& d = check_data("ActionModelUnicycle::calcDiff", data);
  const double w = weights_[0] * weights_[0];
  d.Fx.setIdentity();
  d.Lx = w * x;
  d.Lxx.diagonal().setConstant(w);
}

void ActionModelUnicycle::print(std::ostream& os) const { os << "ActionModelUnicycle {dt=" << dt_ << "}"; }

}  // namespace manycontact
