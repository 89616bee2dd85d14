#include "manycontact/detail/action/num_diff_parts.hpp"

#include <Eigen/QR>

#include "assign.hpp"
#include "by_node.hpp"
#include "differences.hpp"
#include "node_num_diff.hpp"

namespace manycontact {

using internal::jacobian;
using internal::jacobian_by_u;

namespace {

Eigen::Index size(std::size_t n) { return static_cast<Eigen::Index>(n); }

struct Differences {
  Eigen::MatrixXd x, u;  // derivatives w.r.t. x and u, those for u empty in a terminal node
};

// Differentiates value(data) at x, u by central differences. before(x, u) precedes each calc; the last is at x, u.
template <class Model, class Data, class Before, class Value>
Differences differences(Model& model, const std::shared_ptr<Data>& data, const Eigen::VectorXd& x,
                        const Eigen::VectorXd& u, bool terminal, double h, Before&& before, Value&& value) {
  const StateAbstract& state = *model.get_state();
  const auto at = [&](const Eigen::VectorXd& at_x, const Eigen::VectorXd& at_u) -> Eigen::VectorXd {
    before(at_x, at_u);
    if (terminal)
      model.calc(data, at_x);
    else
      model.calc(data, at_x, at_u);
    return value(*data);
  };
  const Eigen::Index rows = value(*data).size();
  Differences by;
  by.x = jacobian(rows, size(state.get_ndx()), h,
                  [&](const Eigen::VectorXd& dx) { return at(state.integrate_x(x, dx), u); });
  if (!terminal) by.u = jacobian_by_u(rows, u, h, [&](const Eigen::VectorXd& at_u) { return at(x, at_u); });
  (void)at(x, u);
  return by;
}

}  // namespace

StateNumDiff::StateNumDiff(std::shared_ptr<StateAbstract> state)
    : StateAbstract(internal::given("StateNumDiff", state)->get_nx(), state->get_ndx()),
      state_model_(std::move(state)) {
  nq_ = state_model_->get_nq();
  nv_ = state_model_->get_nv();
  set_lb(state_model_->get_lb());
  set_ub(state_model_->get_ub());
}

void StateNumDiff::Jdiff(const ConstVectorRef& x0, const ConstVectorRef& x1, MatrixRef Jfirst, MatrixRef Jsecond,
                         Jcomponent which) const {
  const StateAbstract& s = *state_model_;
  const Eigen::Index n = size(ndx_);
  if (which != second)
    Jfirst = jacobian(n, n, step_, [&](const Eigen::VectorXd& d) { return s.diff_dx(s.integrate_x(x0, d), x1); });
  if (which != first)
    Jsecond = jacobian(n, n, step_, [&](const Eigen::VectorXd& d) { return s.diff_dx(x0, s.integrate_x(x1, d)); });
}

void StateNumDiff::Jintegrate(const ConstVectorRef& x, const ConstVectorRef& dx, MatrixRef Jfirst, MatrixRef Jsecond,
                              Jcomponent which, AssignmentOp op) const {
  const StateAbstract& s = *state_model_;
  const Eigen::Index n = size(ndx_);
  const Eigen::VectorXd to = s.integrate_x(x, dx);
  const auto by = [&](auto&& moved) {
    return jacobian(n, n, step_, [&](const Eigen::VectorXd& d) { return s.diff_dx(to, moved(d)); });
  };
  if (which != second)
    internal::assign(Jfirst, by([&](const auto& d) { return s.integrate_x(s.integrate_x(x, d), dx); }), op);
  if (which != first) internal::assign(Jsecond, by([&](const auto& d) { return s.integrate_x(x, dx + d); }), op);
}

void StateNumDiff::JintegrateTransport(const ConstVectorRef& x, const ConstVectorRef& dx, MatrixRef Jin,
                                       Jcomponent which) const {
  require(which != both, "StateNumDiff::JintegrateTransport", "first or second is expected");
  Jin = (Jintegrate_Js(x, dx, which)[0] * Jin).eval();
}

ActivationDataNumDiff::ActivationDataNumDiff(const ActivationModelNumDiff* model)
    : ActivationDataAbstract(model->get_nr()), data_0(model->get_model()->createData()) {
  Arr_.setZero(Ar.size(), Ar.size());
}

std::shared_ptr<ActivationDataAbstract> ActivationModelNumDiff::createData() {
  return std::make_shared<ActivationDataNumDiff>(this);
}

void ActivationModelNumDiff::calc(const DataPtr& data, const ConstVectorRef& r) {
  auto& d = internal::own_data<ActivationDataNumDiff>("ActivationModelNumDiff::calc", data);
  model_->calc(d.data_0, r);
  d.a_value = d.data_0->a_value;
}

void ActivationModelNumDiff::calcDiff(const DataPtr& data, const ConstVectorRef& r) {
  auto& d = internal::own_data<ActivationDataNumDiff>("ActivationModelNumDiff::calcDiff", data);
  const auto value = [&](const Eigen::VectorXd& at) {
    model_->calc(d.data_0, at);
    return Eigen::VectorXd::Constant(1, d.data_0->a_value).eval();
  };
  d.Ar = jacobian(1, r.size(), step_, [&](const Eigen::VectorXd& dr) { return value(r + dr); }).transpose();
  const auto gradient = [&](const Eigen::VectorXd& at) {
    model_->calc(d.data_0, at);
    model_->calcDiff(d.data_0, at);
    return d.data_0->Ar;
  };
  d.Arr_ = jacobian(r.size(), r.size(), step_, [&](const Eigen::VectorXd& dr) { return gradient(r + dr); });
  d.Arr.diagonal() = d.Arr_.diagonal();
  calc(data, r);
}

ActuationDataNumDiff::ActuationDataNumDiff(const ActuationModelNumDiff* model)
    : ActuationDataAbstract(model), data_0(model->get_model()->createData()) {
  tau_set = data_0->tau_set;
}

std::shared_ptr<ActuationDataAbstract> ActuationModelNumDiff::createData() {
  return std::make_shared<ActuationDataNumDiff>(this);
}

void ActuationModelNumDiff::evaluate(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef* u) {
  auto& d = internal::own_data<ActuationDataNumDiff>("ActuationModelNumDiff::calc", data);
  internal::calc(*model_, d.data_0, x, u);
  d.tau = d.data_0->tau;
}

void ActuationModelNumDiff::differentiate(const DataPtr& data, const Eigen::VectorXd& x, const Eigen::VectorXd& u,
                                          bool terminal) {
  auto& d = internal::own_data<ActuationDataNumDiff>("ActuationModelNumDiff::calcDiff", data);
  if (!terminal) check("ActuationModelNumDiff::calcDiff", x, u);
  const Differences by = differences(
      *model_, d.data_0, x, u, terminal, step_, [](const auto&, const auto&) {},
      [](const ActuationDataAbstract& at) { return at.tau; });
  d.dtau_dx = by.x;
  if (!terminal) d.dtau_du = by.u;
  d.tau = d.data_0->tau;
}

void ActuationModelNumDiff::commands(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef& tau) {
  auto& d = internal::own_data<ActuationDataNumDiff>("ActuationModelNumDiff::commands", data);
  model_->commands(d.data_0, x, tau);
  d.u = d.data_0->u;
}

void ActuationModelNumDiff::torqueTransform(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef& u) {
  calcDiff(data, x, u);
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> inverse;
  inverse.setThreshold(step_);  // larger than the errors of the differences, which are O(step^2)
  inverse.compute(Eigen::MatrixXd(data->dtau_du));
  data->Mtau = inverse.pseudoInverse();
}

std::shared_ptr<ResidualDataAbstract> ResidualModelNumDiff::createData(DataCollector* shared) {
  auto data = std::make_shared<ResidualDataNumDiff>(this, shared);
  lay_out(*data);
  return data;
}

void ResidualModelNumDiff::evaluate(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef* u) {
  auto& d = internal::own_data<ResidualDataNumDiff>("ResidualModelNumDiff::calc", data);
  internal::calc(*model_, d.data_0, x, u);
  d.r = d.data_0->r;
}

void ResidualModelNumDiff::differences_of(const DataPtr& data, const Eigen::VectorXd& x, const Eigen::VectorXd& u,
                                          bool terminal) {
  auto& d = internal::own_data<ResidualDataNumDiff>("ResidualModelNumDiff::calcDiff", data);
  const Differences by = differences(
      *model_, d.data_0, x, u, terminal, step_, [&](const auto& at_x, const auto& at_u) { reevaluate(at_x, at_u); },
      [](const ResidualDataAbstract& at) { return at.r; });
  d.Rx = by.x;
  if (!terminal) d.Ru = by.u;
  d.r = d.data_0->r;
}

template <class Model, class Data>
void PartNumDiff<Model, Data>::differentiate(const std::shared_ptr<Data>& data, const Eigen::VectorXd& x,
                                             const Eigen::VectorXd& u, bool terminal) const {
  check_data((std::string(name_) + "::calcDiff").c_str(), data);
  const Differences by = differences(
      *model_, data, x, u, terminal, this->step_, [&](const auto& at_x, const auto& at_u) { reevaluate(at_x, at_u); },
      [&](const Data& at) { return values(at); });
  store(by.x, terminal ? nullptr : &by.u, *data);
}

template class PartNumDiff<CostModelAbstract, CostDataAbstract>;
template class PartNumDiff<ConstraintModelAbstract, ConstraintDataAbstract>;

std::shared_ptr<CostDataAbstract> CostModelNumDiff::createData(DataCollector* shared) {
  require(shared && shared->whole, "CostModelNumDiff::createData", "a collector without an action model is expected");
  return model_->createData(shared);
}

Eigen::VectorXd CostModelNumDiff::values(const CostDataAbstract& d) const {
  Eigen::VectorXd out(1 + d.residual->r.size());
  out << d.cost, d.residual->r;
  return out;
}

// Computes the cost's Gauss-Newton derivatives from the residual's Jacobians by_x, by_u and the activation's Ar, Arr.
void CostModelNumDiff::store(const Eigen::MatrixXd& by_x, const Eigen::MatrixXd* by_u, CostDataAbstract& d) const {
  const Eigen::Index nr = d.residual->r.size();
  model_->get_activation()->calcDiff(d.activation, d.residual->r);
  const auto& Arr = d.activation->Arr;
  d.Lx = by_x.row(0);
  d.residual->Rx = by_x.bottomRows(nr);
  d.Lxx = d.residual->Rx.transpose() * Arr * d.residual->Rx;
  if (!by_u) return;
  d.Lu = by_u->row(0);
  d.residual->Ru = by_u->bottomRows(nr);
  d.Lxu = d.residual->Rx.transpose() * Arr * d.residual->Ru;
  d.Luu = d.residual->Ru.transpose() * Arr * d.residual->Ru;
}

Eigen::VectorXd ConstraintModelNumDiff::values(const ConstraintDataAbstract& d) const {
  Eigen::VectorXd out(d.g.size() + d.h.size());
  out << d.g, d.h;
  return out;
}

void ConstraintModelNumDiff::store(const Eigen::MatrixXd& by_x, const Eigen::MatrixXd* by_u,
                                   ConstraintDataAbstract& d) const {
  d.Gx = by_x.topRows(d.g.size());
  d.Hx = by_x.bottomRows(d.h.size());
  if (!by_u) return;
  d.Gu = by_u->topRows(d.g.size());
  d.Hu = by_u->bottomRows(d.h.size());
}

void ContactModelNumDiff::calcDiff(const std::shared_ptr<ContactDataAbstract>& data, const ConstVectorRef& x) {
  const StateMultibody& state = *model_->get_state();
  const Eigen::VectorXd no_controls = Eigen::VectorXd::Zero(size(model_->get_nu()));
  const auto a0 = [&](const Eigen::VectorXd& at_x) {
    reevaluate(at_x, no_controls);
    model_->calc(data, at_x);
    return data->a0;
  };
  data->da0_dx = jacobian(size(model_->get_nc()), size(state.get_ndx()), step_,
                          [&](const Eigen::VectorXd& dx) { return a0(state.integrate_x(x, dx)); });
  (void)a0(x);
}

template class NodeNumDiff<DifferentialActionModelAbstract, DifferentialActionDataAbstract>;

constexpr const char* kNumDiff = "DifferentialActionModelNumDiff";

void internal::Step::set_disturbance(double disturbance) {
  require(disturbance > 0 && std::isfinite(disturbance), where_,
          std::to_string(disturbance) + " was given, a positive number is expected");
  step_ = disturbance;
}

DifferentialActionModelNumDiff::DifferentialActionModelNumDiff(std::shared_ptr<DifferentialActionModelAbstract> model,
                                                               bool with_gauss_approx)
    : NodeNumDiff(kNumDiff, std::move(model), with_gauss_approx, &DifferentialActionDataAbstract::xout,
                  "DifferentialActionModelNumDiff::set_disturbance") {}

std::shared_ptr<DifferentialActionDataAbstract> DifferentialActionModelNumDiff::createData() {
  return std::make_shared<DifferentialActionDataNumDiff>(this);
}

std::string DifferentialActionModelNumDiff::where(const char*) const { return kNumDiff; }

Eigen::VectorXd DifferentialActionModelNumDiff::coordinates(const DifferentialActionDataAbstract&,
                                                            const DifferentialActionDataAbstract& moved,
                                                            bool terminal) const {
  return terminal ? Eigen::VectorXd::Zero(state_->get_nv()).eval() : moved.xout;  // terminal: no acceleration
}

}  // namespace manycontact
