#include "manycontact/control/integrated_action.hpp"

#include <cmath>

#include "steps.hpp"

namespace manycontact {

namespace {

constexpr const char* kIntegratedActionModel = "IntegratedActionModel";

// Returns the model if it is not null. Each argument of a constructor is checked, because their order is unspecified.
const DifferentialActionModelAbstract& checked(const std::shared_ptr<DifferentialActionModelAbstract>& model) {
  return *internal::given(kIntegratedActionModel, model, "a differential action model");
}

}  // namespace

IntegratedActionModelAbstract::IntegratedActionModelAbstract(
    std::shared_ptr<DifferentialActionModelAbstract> model,
    std::shared_ptr<ControlParametrizationModelAbstract> control, double time_step, bool with_cost_residual)
    : ActionModelAbstract(checked(model).get_state(),
                          internal::given(kIntegratedActionModel, control, "a control parametrization")->get_nu(),
                          checked(model).get_nr(), checked(model).get_ng(), checked(model).get_nh(),
                          checked(model).get_ng_T(), checked(model).get_nh_T()),
      differential_(std::move(model)),
      control_(std::move(control)),
      with_cost_residual_(with_cost_residual) {
  require(control_->get_nw() == differential_->get_nu(), kIntegratedActionModel,
          "the control parametrization has nw = " + std::to_string(control_->get_nw()) +
              ", nw = " + std::to_string(differential_->get_nu()) + ", the model's nu, is expected");
  set_dt(time_step);
  control_->convertBounds(differential_->get_u_lb(), differential_->get_u_ub(), u_lb_, u_ub_);
  update_has_control_limits();
}

IntegratedActionModelAbstract::IntegratedActionModelAbstract(std::shared_ptr<DifferentialActionModelAbstract> model,
                                                             double time_step, bool with_cost_residual)
    : IntegratedActionModelAbstract(model,
                                    std::make_shared<ControlParametrizationModelPolyZero>(checked(model).get_nu()),
                                    time_step, with_cost_residual) {}

void IntegratedActionModelAbstract::set_dt(double dt) {
  require(dt >= 0 && std::isfinite(dt), kIntegratedActionModel,
          "a time step of " + std::to_string(dt) + " s was given, a finite time step that is not negative is expected");
  time_step_ = dt;
  time_step2_ = dt * dt;
}

bool IntegratedActionModelAbstract::checkData(const DataPtr& data) {
  const auto* d = dynamic_cast<const IntegratedActionDataAbstract*>(data.get());
  for (std::size_t i = 0; d && i < d->stages(); ++i)
    if (!differential_->checkData(d->stage(i).differential)) return false;
  return data != nullptr;
}

// Computes u from the quasi-static torques of the differential model, at the first stage of the step.
void IntegratedActionModelAbstract::quasiStatic(const DataPtr& data, VectorRef u, const ConstVectorRef& x,
                                                std::size_t maxiter, double tol) {
  const auto* d = dynamic_cast<const IntegratedActionDataAbstract*>(data.get());
  if (!d) return ActionModelAbstract::quasiStatic(data, u, x, maxiter, tol);
  const IntegratorStage first = d->stage(0);
  differential_->quasiStatic(first.differential, first.control->w, x, maxiter, tol);
  control_->params(first.control, 0, first.control->w);
  u = first.control->u;
}

void IntegratedActionModelAbstract::calc_terminal(const ConstVectorRef& x, IntegratedActionDataAbstract& d) const {
  const auto& from = d.stage(0).differential;
  differential_->calc(from, x);
  d.dx.setZero();
  d.xnext = x;
  d.cost = from->cost;
  internal::copy_values(*from, with_cost_residual_, d);
}

void IntegratedActionModelAbstract::calcDiff_terminal(const ConstVectorRef& x, IntegratedActionDataAbstract& d) const {
  const auto& from = d.stage(0).differential;
  differential_->calcDiff(from, x);
  d.Lx = from->Lx;
  if (!d.has_matrices()) return;
  internal::check_dense("IntegratedActionModel::calcDiff", *from);
  d.Fx.setIdentity();
  d.Lxx = from->Lxx;
  d.Gx = from->Gx;
  d.Hx = from->Hx;
}

}  // namespace manycontact
