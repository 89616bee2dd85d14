#include "manycontact/control/num_diff.hpp"

#include <cmath>
#include <ostream>

namespace manycontact {

using DataPtr = std::shared_ptr<ActionDataAbstract>;
using internal::own_data;

ActionDataNumDiff::ActionDataNumDiff(ActionModelNumDiff* model)
    : ActionDataAbstract(model),
      data_0(model->get_model()->createData()),
      data_step(model->get_model()->createData()) {}

namespace {

const ActionModelAbstract& given(const std::shared_ptr<ActionModelAbstract>& model) {
  require(model != nullptr, "ActionModelNumDiff", "a model is expected, not a null pointer");
  return *model;
}

void copy_values(const ActionDataAbstract& from, ActionDataAbstract& to) {
  to.xnext = from.xnext;
  to.cost = from.cost;
  to.r = from.r;
  to.g = from.g;
  to.h = from.h;
}

}  // namespace

ActionModelNumDiff::ActionModelNumDiff(std::shared_ptr<ActionModelAbstract> model, bool with_gauss_approx)
    : ActionModelAbstract(given(model).get_state(), given(model).get_nu()),
      model_(std::move(model)),
      gauss_(with_gauss_approx),
      step_(std::cbrt(std::numeric_limits<double>::epsilon())) {
  u_lb_ = model_->get_u_lb();
  u_ub_ = model_->get_u_ub();
  update_has_control_limits();
}

void ActionModelNumDiff::set_disturbance(double disturbance) {
  require(disturbance > 0 && std::isfinite(disturbance), "ActionModelNumDiff::set_disturbance",
          "a positive number is expected");
  step_ = disturbance;
}

DataPtr ActionModelNumDiff::createData() { return std::make_shared<ActionDataNumDiff>(this); }

// The model around a point: x moved along the tangent, u as it is, or the reverse.
struct ActionModelNumDiff::At {
  ActionModelAbstract& model;
  DataPtr data;
  Eigen::VectorXd x, u;
  bool terminal;

  const ActionDataAbstract& operator()(const Eigen::VectorXd& dx, const Eigen::VectorXd& du) {
    const Eigen::VectorXd at = model.get_state()->integrate_x(x, dx);
    if (terminal)
      model.calc(data, at);
    else
      model.calc(data, at, u + du);
    return *data;
  }
};

void ActionModelNumDiff::calc(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef& u) {
  auto& d = own_data<ActionDataNumDiff>("ActionModelNumDiff::calc", data);
  model_->calc(d.data_0, x, u);
  copy_values(*d.data_0, d);
}

void ActionModelNumDiff::calc(const DataPtr& data, const ConstVectorRef& x) {
  auto& d = own_data<ActionDataNumDiff>("ActionModelNumDiff::calc", data);
  model_->calc(d.data_0, x);
  copy_values(*d.data_0, d);
}

void ActionModelNumDiff::differentiate(ActionDataAbstract& data, At& at) const {
  auto& d = static_cast<ActionDataNumDiff&>(data);
  const Eigen::Index ndx = state_->get_ndx(), nu = nu_;
  const Eigen::Index nr = d.r.size(), ng = d.g.size(), nh = d.h.size();
  d.Fx.setZero(ndx, ndx), d.Fu.setZero(ndx, nu);
  d.Rx.setZero(nr, ndx), d.Ru.setZero(nr, nu);
  d.Gx.setZero(ng, ndx), d.Gu.setZero(ng, nu);
  d.Hx.setZero(nh, ndx), d.Hu.setZero(nh, nu);
  const auto differ = [&](bool by_x, Eigen::Index i, Eigen::VectorXd& L, Eigen::MatrixXd& F, Eigen::MatrixXd& R,
                          Eigen::MatrixXd& G, Eigen::MatrixXd& H) {
    Eigen::VectorXd dx = Eigen::VectorXd::Zero(ndx), du = Eigen::VectorXd::Zero(nu);
    const double h = by_x ? step_ : step_ * std::max(1.0, std::abs(at.u[i]));
    (by_x ? dx : du)[i] = h;
    ActionDataAbstract plus(this);
    copy_values(at(dx, du), plus);
    const ActionDataAbstract& minus = at(-dx, -du);
    L[i] = (plus.cost - minus.cost) / (2 * h);
    F.col(i) = (state_->diff_dx(d.xnext, plus.xnext) - state_->diff_dx(d.xnext, minus.xnext)) / (2 * h);
    R.col(i) = (plus.r - minus.r) / (2 * h);
    G.col(i) = (plus.g - minus.g) / (2 * h);
    H.col(i) = (plus.h - minus.h) / (2 * h);
  };
  for (Eigen::Index i = 0; i < ndx; ++i) differ(true, i, d.Lx, d.Fx, d.Rx, d.Gx, d.Hx);
  for (Eigen::Index i = 0; i < nu && !at.terminal; ++i) differ(false, i, d.Lu, d.Fu, d.Ru, d.Gu, d.Hu);
  if (gauss_) {
    d.Lxx = d.Rx.transpose() * d.Rx;
    d.Lxu = d.Rx.transpose() * d.Ru;
    d.Luu = d.Ru.transpose() * d.Ru;
  } else {
    second_differences(d, at);
  }
}

// L_ij = (L(+,+) - L(+,-) - L(-,+) + L(-,-)) / 4h^2
void ActionModelNumDiff::second_differences(ActionDataAbstract& d, At& at) const {
  const Eigen::Index ndx = state_->get_ndx(), nu = nu_, n = ndx + (at.terminal ? 0 : nu);
  const double h = std::pow(std::numeric_limits<double>::epsilon(), 0.25);
  Eigen::MatrixXd L(n, n);
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index j = 0; j <= i; ++j) {
      double sum = 0;
      for (int s : {1, -1})
        for (int t : {1, -1}) {
          Eigen::VectorXd dz = Eigen::VectorXd::Zero(ndx + nu);
          dz[i] += s * h;
          dz[j] += t * h;
          sum += s * t * at(dz.head(ndx), dz.tail(nu)).cost;
        }
      L(i, j) = L(j, i) = sum / (4 * h * h);
    }
  d.Lxx = L.topLeftCorner(ndx, ndx);
  if (at.terminal) return;
  d.Lxu = L.topRightCorner(ndx, nu);
  d.Luu = L.bottomRightCorner(nu, nu);
}

void ActionModelNumDiff::calcDiff(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef& u) {
  auto& d = own_data<ActionDataNumDiff>("ActionModelNumDiff::calcDiff", data);
  At at{*model_, d.data_step, x, u, false};
  differentiate(d, at);
}

void ActionModelNumDiff::calcDiff(const DataPtr& data, const ConstVectorRef& x) {
  auto& d = own_data<ActionDataNumDiff>("ActionModelNumDiff::calcDiff", data);
  At at{*model_, d.data_step, x, Eigen::VectorXd::Zero(nu_), true};
  differentiate(d, at);
}

void ActionModelNumDiff::quasiStatic(const DataPtr& data, VectorRef u, const ConstVectorRef& x, std::size_t maxiter,
                                     double tol) {
  auto& d = own_data<ActionDataNumDiff>("ActionModelNumDiff::quasiStatic", data);
  model_->quasiStatic(d.data_0, u, x, maxiter, tol);
}

void ActionModelNumDiff::print(std::ostream& os) const { os << "ActionModelNumDiff {" << *model_ << "}"; }

}  // namespace manycontact
