#include "manycontact/action/squashing.hpp"

#include <cmath>
#include <ostream>

namespace manycontact {

SquashingDataAbstract::SquashingDataAbstract(const SquashingModelAbstract* model) {
  const auto ns = static_cast<Eigen::Index>(model->get_ns());
  u.setZero(ns);
  du_ds.setZero(ns, ns);
}

SquashingModelAbstract::SquashingModelAbstract(std::size_t ns) : ns_(ns) {
  require(ns > 0, "SquashingModelAbstract", "ns is 0, a number of 1 or more is expected");
}

SquashingModelSmoothSat::SquashingModelSmoothSat(const ConstVectorRef& u_lb, const ConstVectorRef& u_ub, std::size_t ns)
    : SquashingModelAbstract(ns) {
  check_size("SquashingModelSmoothSat", "the lower bound", u_lb.size(), ns);
  check_size("SquashingModelSmoothSat", "the upper bound", u_ub.size(), ns);
  require(u_lb.allFinite() && u_ub.allFinite() && (u_lb.array() < u_ub.array()).all(), "SquashingModelSmoothSat",
          "finite bounds are expected, and each lower bound below the upper bound");
  u_lb_ = s_lb_ = u_lb;
  u_ub_ = s_ub_ = u_ub;
  set_smooth(smooth_);
}

void SquashingModelSmoothSat::set_smooth(double smooth) {
  require(smooth >= 0 && std::isfinite(smooth), "SquashingModelSmoothSat::set_smooth",
          std::to_string(smooth) + " was given, a finite number that is not negative is expected");
  smooth_ = smooth;
  d_ = smooth * (u_ub_ - u_lb_);
}

void SquashingModelSmoothSat::calc(const DataPtr& data, const ConstVectorRef& s) {
  check_size("SquashingModelSmoothSat::calc", "s", s.size(), ns_);
  SquashingDataAbstract& d = check_data("SquashingModelSmoothSat::calc", data);
  for (Eigen::Index i = 0; i < s.size(); ++i)
    d.u[i] = 0.5 * (u_lb_[i] + u_ub_[i] + std::hypot(s[i] - u_lb_[i], d_[i]) - std::hypot(s[i] - u_ub_[i], d_[i]));
}

void SquashingModelSmoothSat::calcDiff(const DataPtr& data, const ConstVectorRef& s) {
  check_size("SquashingModelSmoothSat::calcDiff", "s", s.size(), ns_);
  SquashingDataAbstract& d = check_data("SquashingModelSmoothSat::calcDiff", data);
  const auto slope = [](double distance, double smooth) {
    const double length = std::hypot(distance, smooth);
    return length > 0 ? distance / length : 0.0;
  };
  for (Eigen::Index i = 0; i < s.size(); ++i)
    d.du_ds(i, i) = 0.5 * (slope(s[i] - u_lb_[i], d_[i]) - slope(s[i] - u_ub_[i], d_[i]));
}

constexpr const char* kActuationSquashingModel = "ActuationSquashingModel";

ActuationSquashingData::ActuationSquashingData(const ActuationSquashingModel* model)
    : ActuationDataAbstract(model),
      squashing(model->get_squashing()->createData()),
      actuation(model->get_actuation()->createData()) {
  tau_set = actuation->tau_set;
}

ActuationSquashingModel::ActuationSquashingModel(std::shared_ptr<ActuationModelAbstract> actuation,
                                                 std::shared_ptr<SquashingModelAbstract> squashing, std::size_t nu)
    : ActuationModelAbstract(internal::given(kActuationSquashingModel, actuation, "an actuation")->get_state(), nu),
      squashing_(internal::given(kActuationSquashingModel, squashing, "a squashing")),
      actuation_(std::move(actuation)) {
  require(nu == actuation_->get_nu() && nu == squashing_->get_ns(), kActuationSquashingModel,
          "nu is " + std::to_string(nu) + ", the actuation has nu = " + std::to_string(actuation_->get_nu()) +
              ", the squashing has ns = " + std::to_string(squashing_->get_ns()) + ", equal numbers are expected");
}

void ActuationSquashingModel::calc(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef& u) {
  auto& d = internal::own_data<ActuationSquashingData>("ActuationSquashingModel::calc", data);
  squashing_->calc(d.squashing, u);
  actuation_->calc(d.actuation, x, d.squashing->u);
  d.tau = d.actuation->tau;
}

// Computes dtau/ds = dtau/du du/ds, where u(s) are the squashed controls.
void ActuationSquashingModel::calcDiff(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef& u) {
  auto& d = internal::own_data<ActuationSquashingData>("ActuationSquashingModel::calcDiff", data);
  squashing_->calc(d.squashing, u);
  squashing_->calcDiff(d.squashing, u);
  actuation_->calcDiff(d.actuation, x, d.squashing->u);
  d.dtau_dx = static_cast<const Eigen::SparseMatrix<double>&>(d.actuation->dtau_dx);
  d.dtau_du = (d.actuation->dtau_du * d.squashing->du_ds).eval();
}

void ActuationSquashingModel::commands(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef& tau) {
  check_size("ActuationSquashingModel::commands", "x", x.size(), state_->get_nx());
  check_size("ActuationSquashingModel::commands", "tau", tau.size(), state_->get_nv());
  auto& d = internal::own_data<ActuationSquashingData>("ActuationSquashingModel::commands", data);
  actuation_->commands(d.actuation, x, tau);
  torqueTransform(data, x, d.actuation->u);
  d.u = d.Mtau * tau;
}

std::shared_ptr<ActuationDataAbstract> ActuationSquashingModel::createData() {
  return std::make_shared<ActuationSquashingData>(this);
}

void ActuationSquashingModel::print(std::ostream& os) const {
  os << kActuationSquashingModel << " {nu=" << nu_ << ", " << *actuation_ << "}";
}

}  // namespace manycontact
