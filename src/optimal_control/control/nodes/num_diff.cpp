#include "manycontact/control/num_diff.hpp"

#include <cmath>
#include <ostream>

#include "../../action/differences.hpp"

namespace manycontact {

using DataPtr = std::shared_ptr<ActionDataAbstract>;
using internal::given;
using internal::own_data;

ActionDataNumDiff::ActionDataNumDiff(ActionModelNumDiff* model)
    : ActionDataAbstract(model),
      data_0(model->get_model()->createData()),
      data_step(model->get_model()->createData()) {}

namespace {

constexpr const char* kNumDiff = "ActionModelNumDiff";

void copy_values(const ActionDataAbstract& from, ActionDataAbstract& to) {
  to.xnext = from.xnext;
  to.cost = from.cost;
  to.r = from.r;
  to.g = from.g;
  to.h = from.h;
}

}  // namespace

ActionModelNumDiff::ActionModelNumDiff(std::shared_ptr<ActionModelAbstract> model, bool with_gauss_approx)
    : ActionModelAbstract(internal::given(kNumDiff, model)->get_state(), internal::given(kNumDiff, model)->get_nu()),
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

void ActionModelNumDiff::differentiate(const DataPtr& data, const Eigen::VectorXd& x, const Eigen::VectorXd& u,
                                       bool terminal) {
  auto& d = own_data<ActionDataNumDiff>("ActionModelNumDiff::calcDiff", data);
  const auto xnext = [](const ActionDataAbstract& from) -> const Eigen::VectorXd& { return from.xnext; };
  const internal::Around<ActionModelAbstract, ActionDataAbstract, decltype(xnext)> at{*model_, d.data_step, xnext,
                                                                                      x,       u,           terminal};
  internal::central_differences(
      at, step_, gauss_, static_cast<Eigen::Index>(state_->get_ndx()),
      [&](const Eigen::VectorXd& plus, const Eigen::VectorXd& minus) -> Eigen::VectorXd {
        return state_->diff_dx(d.xnext, plus) - state_->diff_dx(d.xnext, minus);
      },
      d);
}

void ActionModelNumDiff::calcDiff(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef& u) {
  differentiate(data, x, u, false);
}

void ActionModelNumDiff::calcDiff(const DataPtr& data, const ConstVectorRef& x) {
  differentiate(data, x, Eigen::VectorXd::Zero(static_cast<Eigen::Index>(nu_)), true);
}

void ActionModelNumDiff::quasiStatic(const DataPtr& data, VectorRef u, const ConstVectorRef& x, std::size_t maxiter,
                                     double tol) {
  auto& d = own_data<ActionDataNumDiff>("ActionModelNumDiff::quasiStatic", data);
  model_->quasiStatic(d.data_0, u, x, maxiter, tol);
}

void ActionModelNumDiff::print(std::ostream& os) const { os << "ActionModelNumDiff {" << *model_ << "}"; }

}  // namespace manycontact
