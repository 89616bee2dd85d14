#include "manycontact/action/cost.hpp"

#include <ostream>

namespace manycontact {

CostDataResidual::CostDataResidual(CostModelResidual* model, DataCollector* shared)
    : of_residual(model->get_residual()),
      of_activation(model->get_activation()),
      activation(model->get_activation()->createData()),
      residual(model->get_residual()->createData(shared)) {
  if (!shared || !shared->whole) return;
  const auto ndx = static_cast<Eigen::Index>(model->get_state()->get_ndx());
  const auto nu = static_cast<Eigen::Index>(model->get_nu());
  Lx.setZero(ndx);
  Lu.setZero(nu);
  Lxx.setZero(ndx, ndx);
  Lxu.setZero(ndx, nu);
  Luu.setZero(nu, nu);
}

CostDerivatives CostDataResidual::whole_derivatives() const {
  const Eigen::MatrixXd Rx = residual->whole_Rx(), Ru = residual->whole_Ru();
  const auto& Arr = activation->Arr;
  CostDerivatives out;
  out.Lx = Rx.transpose() * activation->Ar;
  out.Lu = Ru.transpose() * activation->Ar;
  out.Lxx = Rx.transpose() * Arr * Rx;
  out.Lxu = Rx.transpose() * Arr * Ru;
  out.Luu = Ru.transpose() * Arr * Ru;
  return out;
}

CostModelResidual::CostModelResidual(std::shared_ptr<StateAbstract> state,
                                     std::shared_ptr<ActivationModelAbstract> activation,
                                     std::shared_ptr<ResidualModelAbstract> residual)
    : state_(std::move(state)), activation_(std::move(activation)), residual_(std::move(residual)) {
  require(state_ && activation_ && residual_, "CostModelResidual",
          "a null pointer was given, a state, an activation and a residual are expected");
  require(same_space(*residual_->get_state(), *state_), "CostModelResidual",
          "the residual belongs to another state, this one's is expected");
  require(activation_->get_nr() == residual_->get_nr(), "CostModelResidual",
          "the activation has nr = " + std::to_string(activation_->get_nr()) + ", the residual's " +
              std::to_string(residual_->get_nr()) + " is expected");
}

CostModelResidual::CostModelResidual(std::shared_ptr<StateAbstract> state,
                                     std::shared_ptr<ResidualModelAbstract> residual)
    : CostModelResidual(state, std::make_shared<ActivationModelQuad>(residual ? residual->get_nr() : 0), residual) {}

void CostModelResidual::check(const char* where, const std::shared_ptr<CostDataResidual>& data) const {
  const CostDataResidual& d = check_data(where, data);
  require(d.of_residual == residual_ && d.of_activation == activation_, where,
          "the data were created by another cost, data of this one's createData() are expected");
}

void CostModelResidual::calc(const std::shared_ptr<CostDataResidual>& data, const ConstVectorRef& x,
                             const ConstVectorRef& u) {
  check("CostModelResidual::calc", data);
  residual_->calc(data->residual, x, u);
  activation_->calc(data->activation, data->residual->r);
  data->cost = data->activation->a_value;
}

void CostModelResidual::calc(const std::shared_ptr<CostDataResidual>& data, const ConstVectorRef& x) {
  check("CostModelResidual::calc", data);
  residual_->calc(data->residual, x);
  activation_->calc(data->activation, data->residual->r);
  data->cost = data->activation->a_value;
}

void CostModelResidual::calcDiff(const std::shared_ptr<CostDataResidual>& data, const ConstVectorRef& x,
                                 const ConstVectorRef& u) {
  check("CostModelResidual::calcDiff", data);
  residual_->calcDiff(data->residual, x, u);
  finish_derivatives(*data, false);
}

void CostModelResidual::calcDiff(const std::shared_ptr<CostDataResidual>& data, const ConstVectorRef& x) {
  check("CostModelResidual::calcDiff", data);
  residual_->calcDiff(data->residual, x);
  finish_derivatives(*data, true);
}

void CostModelResidual::finish_derivatives(CostDataResidual& data, bool terminal) const {
  residual_->take_whole(*data.residual);
  activation_->calcDiff(data.activation, data.residual->r);
  if (data.Lx.size() == 0) return;
  CostDerivatives d = data.whole_derivatives();
  data.Lx.swap(d.Lx);
  data.Lxx.swap(d.Lxx);
  if (terminal) return;
  data.Lu.swap(d.Lu);
  data.Lxu.swap(d.Lxu);
  data.Luu.swap(d.Luu);
}

std::shared_ptr<CostDataResidual> CostModelResidual::createData(DataCollector* shared) {
  return std::make_shared<CostDataResidual>(this, shared);
}

void CostModelResidual::print(std::ostream& os) const {
  os << "CostModelResidual {" << *residual_ << ", " << *activation_ << "}";
}

std::ostream& operator<<(std::ostream& os, const CostModelResidual& model) {
  model.print(os);
  return os;
}

}  // namespace manycontact
