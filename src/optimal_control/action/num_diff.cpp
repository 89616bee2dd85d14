#include "manycontact/action/num_diff.hpp"

#include <cmath>
#include <ostream>

#include "differences.hpp"

namespace manycontact {

using NumDiff = DifferentialActionModelNumDiff;
using internal::given;

DifferentialActionDataNumDiff::DifferentialActionDataNumDiff(NumDiff* model)
    : DifferentialActionDataAbstract(model),
      data_0(model->get_model()->createData()),
      data_step(model->get_model()->createData()) {}

namespace {
constexpr const char* kNumDiff = "DifferentialActionModelNumDiff";
}  // namespace

NumDiff::DifferentialActionModelNumDiff(std::shared_ptr<DifferentialActionModelAbstract> model, bool with_gauss_approx)
    : DifferentialActionModelAbstract(internal::given(kNumDiff, model)->get_state(),
                                      internal::given(kNumDiff, model)->get_nu()),
      model_(std::move(model)),
      gauss_(with_gauss_approx),
      step_(std::cbrt(std::numeric_limits<double>::epsilon())) {
  u_lb_ = model_->get_u_lb();
  u_ub_ = model_->get_u_ub();
  update_has_control_limits();
}

void NumDiff::set_disturbance(double disturbance) {
  require(disturbance > 0 && std::isfinite(disturbance), "DifferentialActionModelNumDiff::set_disturbance",
          std::to_string(disturbance) + " was given, a positive number is expected");
  step_ = disturbance;
}

std::shared_ptr<DifferentialActionDataAbstract> NumDiff::createData() {
  return std::make_shared<DifferentialActionDataNumDiff>(this);
}

namespace {

DifferentialActionDataNumDiff& num_diff_data(const std::shared_ptr<DifferentialActionDataAbstract>& data) {
  return internal::own_data<DifferentialActionDataNumDiff>(kNumDiff, data);
}

void copy_values(const DifferentialActionDataAbstract& from, DifferentialActionDataAbstract& to) {
  to.xout = from.xout;
  to.cost = from.cost;
  to.r = from.r;
  to.g = from.g;
  to.h = from.h;
}

}  // namespace

void NumDiff::calc(const std::shared_ptr<DifferentialActionDataAbstract>& data, const ConstVectorRef& x,
                   const ConstVectorRef& u) {
  DifferentialActionDataNumDiff& d = num_diff_data(data);
  model_->calc(d.data_0, x, u);
  copy_values(*d.data_0, d);
}

void NumDiff::calc(const std::shared_ptr<DifferentialActionDataAbstract>& data, const ConstVectorRef& x) {
  DifferentialActionDataNumDiff& d = num_diff_data(data);
  model_->calc(d.data_0, x);
  copy_values(*d.data_0, d);
}

void NumDiff::differentiate(const std::shared_ptr<DifferentialActionDataAbstract>& data, const Eigen::VectorXd& x,
                            const Eigen::VectorXd& u, bool terminal) {
  DifferentialActionDataNumDiff& d = num_diff_data(data);
  const auto xout = [](const DifferentialActionDataAbstract& from) -> const Eigen::VectorXd& { return from.xout; };
  const internal::Around<DifferentialActionModelAbstract, DifferentialActionDataAbstract, decltype(xout)> at{
      *model_, d.data_step, xout, x, u, terminal};
  const Eigen::Index nv = static_cast<Eigen::Index>(state_->get_nv());
  internal::central_differences(
      at, step_, gauss_, nv,
      [&](const Eigen::VectorXd& plus, const Eigen::VectorXd& minus) -> Eigen::VectorXd {
        if (terminal) return Eigen::VectorXd::Zero(nv);  // a terminal node has no acceleration
        return plus - minus;
      },
      d);
}

void NumDiff::calcDiff(const std::shared_ptr<DifferentialActionDataAbstract>& data, const ConstVectorRef& x,
                       const ConstVectorRef& u) {
  differentiate(data, x, u, false);
}

void NumDiff::calcDiff(const std::shared_ptr<DifferentialActionDataAbstract>& data, const ConstVectorRef& x) {
  differentiate(data, x, Eigen::VectorXd::Zero(static_cast<Eigen::Index>(nu_)), true);
}

void NumDiff::quasiStatic(const std::shared_ptr<DifferentialActionDataAbstract>& data, VectorRef u,
                          const ConstVectorRef& x, std::size_t maxiter, double tol) {
  model_->quasiStatic(num_diff_data(data).data_0, u, x, maxiter, tol);
}

void NumDiff::print(std::ostream& os) const { os << "DifferentialActionModelNumDiff {" << *model_ << "}"; }

}  // namespace manycontact
