#include <cmath>

#include "manycontact/control/control_parametrization.hpp"

namespace manycontact {

using NumDiff = ControlParametrizationModelNumDiff;
using ConstMatrixRef = Eigen::Ref<const Eigen::MatrixXd>;

namespace {

constexpr const char* kNumDiff = "ControlParametrizationModelNumDiff";

ControlParametrizationDataNumDiff& own(const NumDiff::Data& data) {
  return internal::own_data<ControlParametrizationDataNumDiff>(kNumDiff, data);
}

void put(const Eigen::MatrixXd& value, MatrixRef out, AssignmentOp op) {
  if (op == setto)
    out = value;
  else
    out += op == addto ? value : Eigen::MatrixXd(-value);
}

}  // namespace

ControlParametrizationDataNumDiff::ControlParametrizationDataNumDiff(const NumDiff* model)
    : ControlParametrizationDataAbstract(model), data_0(model->get_model()->createData()) {}

NumDiff::ControlParametrizationModelNumDiff(std::shared_ptr<ControlParametrizationModelAbstract> model)
    : ControlParametrizationModelAbstract(internal::given(kNumDiff, model)->get_nw(), model->get_nu()),
      model_(std::move(model)),
      step_(std::cbrt(std::numeric_limits<double>::epsilon())) {}

void NumDiff::set_disturbance(double disturbance) {
  require(disturbance > 0 && std::isfinite(disturbance), "ControlParametrizationModelNumDiff::set_disturbance",
          std::to_string(disturbance) + " was given, a positive number is expected");
  step_ = disturbance;
}

NumDiff::Data NumDiff::createData() { return std::make_shared<ControlParametrizationDataNumDiff>(this); }

void NumDiff::calc(const Data& data, double t, const ConstVectorRef& u) const {
  auto& d = own(data);
  model_->calc(d.data_0, t, u);
  d.w = d.data_0->w;
}

void NumDiff::calcDiff(const Data& data, double t, const ConstVectorRef& u) const {
  auto& d = own(data);
  Eigen::VectorXd at = u;
  for (Eigen::Index i = 0; i < u.size(); ++i) {
    const double h = step_ * std::max(1.0, std::abs(u[i]));
    at[i] = u[i] + h;
    model_->calc(d.data_0, t, at);
    d.dw_du.col(i) = d.data_0->w;
    at[i] = u[i] - h;
    model_->calc(d.data_0, t, at);
    d.dw_du.col(i) = (d.dw_du.col(i) - d.data_0->w) / (2 * h);
    at[i] = u[i];
  }
  calc(data, t, u);
}

void NumDiff::params(const Data& data, double t, const ConstVectorRef& w) const {
  auto& d = own(data);
  model_->params(d.data_0, t, w);
  d.u = d.data_0->u;
}

void NumDiff::convertBounds(const ConstVectorRef& w_lb, const ConstVectorRef& w_ub, VectorRef u_lb,
                            VectorRef u_ub) const {
  model_->convertBounds(w_lb, w_ub, u_lb, u_ub);
}

void NumDiff::multiplyByJacobian(const Data& data, const ConstMatrixRef& A, MatrixRef out, AssignmentOp op) const {
  put(A * own(data).dw_du, out, op);
}

void NumDiff::multiplyJacobianTransposeBy(const Data& data, const ConstMatrixRef& A, MatrixRef out,
                                          AssignmentOp op) const {
  put(own(data).dw_du.transpose() * A, out, op);
}

}  // namespace manycontact
