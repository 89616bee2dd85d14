#include "manycontact/action/cost.hpp"

#include <ostream>
#include <stdexcept>
#include <typeinfo>

namespace manycontact {

namespace {

// The output of a user's calc, if the user's cost has no residual.
class OwnResidual final : public ResidualModelAbstract {
 public:
  using ResidualModelAbstract::ResidualModelAbstract;
  void calc(const std::shared_ptr<ResidualDataAbstract>&, const ConstVectorRef&, const ConstVectorRef&) override {}
  void calc(const std::shared_ptr<ResidualDataAbstract>&, const ConstVectorRef&) override {}
  void calcDiff(const std::shared_ptr<ResidualDataAbstract>&, const ConstVectorRef&, const ConstVectorRef&) override {}
  void calcDiff(const std::shared_ptr<ResidualDataAbstract>&, const ConstVectorRef&) override {}
  void print(std::ostream& os) const override { os << "nr=" << nr_; }
};

std::shared_ptr<ResidualModelAbstract> own_residual(const std::shared_ptr<StateAbstract>& state, std::size_t nr,
                                                    std::size_t nu) {
  const std::size_t nv = internal::given("CostModelAbstract", state, "a state")->get_nv();
  return std::make_shared<OwnResidual>(state, nr, nu == kDefaultNu ? nv : nu);
}

std::size_t nr_of(const std::shared_ptr<ActivationModelAbstract>& activation) {
  return internal::given("CostModelAbstract", activation, "an activation")->get_nr();
}

// Gauss-Newton's, of the residual's blocks.
CostDerivatives by_residual(const CostDataAbstract& d) {
  const Eigen::MatrixXd Rx = d.residual->whole_Rx(), Ru = d.residual->whole_Ru();
  const auto& Arr = d.activation->Arr;
  CostDerivatives out;
  out.Lx = Rx.transpose() * d.activation->Ar;
  out.Lu = Ru.transpose() * d.activation->Ar;
  out.Lxx = Rx.transpose() * Arr * Rx;
  out.Lxu = Rx.transpose() * Arr * Ru;
  out.Luu = Ru.transpose() * Arr * Ru;
  return out;
}

}  // namespace

CostDataAbstract::CostDataAbstract(CostModelAbstract* model, DataCollector* s)
    : shared(s),
      of_residual(model->get_residual()),
      of_activation(model->get_activation()),
      activation(model->get_activation()->createData()),
      residual(model->get_residual()->createData(s)),
      own(typeid(*model) != typeid(CostModelResidual)) {
  if (!own && !(shared && shared->whole)) return;
  const auto ndx = static_cast<Eigen::Index>(model->get_state()->get_ndx());
  const auto nu = static_cast<Eigen::Index>(model->get_nu());
  if (residual->Rx.rows() != residual->r.size() || residual->Rx.cols() != ndx) {
    residual->Rx.setZero(residual->r.size(), ndx);
    residual->Ru.setZero(residual->r.size(), nu);
  }
  Lx.setZero(ndx);
  Lu.setZero(nu);
  Lxx.setZero(ndx, ndx);
  Lxu.setZero(ndx, nu);
  Luu.setZero(nu, nu);
}

CostDerivatives CostDataAbstract::whole_derivatives() const {
  if (!own) return by_residual(*this);
  CostDerivatives out;
  out.Lx = Lx, out.Lu = Lu;
  out.Lxx = Lxx, out.Lxu = Lxu, out.Luu = Luu;
  return out;
}

CostModelAbstract::CostModelAbstract(std::shared_ptr<StateAbstract> state,
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
  unone_ = Eigen::VectorXd::Zero(get_nu());
}

CostModelAbstract::CostModelAbstract(std::shared_ptr<StateAbstract> state,
                                     std::shared_ptr<ResidualModelAbstract> residual)
    : CostModelAbstract(state, std::make_shared<ActivationModelQuad>(residual ? residual->get_nr() : 0), residual) {}

CostModelAbstract::CostModelAbstract(std::shared_ptr<StateAbstract> state,
                                     std::shared_ptr<ActivationModelAbstract> activation, std::size_t nu)
    : CostModelAbstract(state, activation, own_residual(state, nr_of(activation), nu)) {}

CostModelAbstract::CostModelAbstract(std::shared_ptr<StateAbstract> state, std::size_t nu)
    : CostModelAbstract(state, std::make_shared<ActivationModelQuad>(0), nu) {}

void CostModelAbstract::calc(const DataPtr& data, const ConstVectorRef& x) { calc(data, x, unone_); }

void CostModelAbstract::calcDiff(const DataPtr&, const ConstVectorRef&, const ConstVectorRef&) {
  throw std::logic_error("CostModelAbstract::calcDiff: the cost has no derivatives, a calcDiff is expected");
}

void CostModelAbstract::calcDiff(const DataPtr& data, const ConstVectorRef& x) { calcDiff(data, x, unone_); }

std::shared_ptr<CostDataAbstract> CostModelAbstract::createData(DataCollector* shared) {
  return std::make_shared<CostDataAbstract>(this, shared);
}

void CostModelAbstract::print(std::ostream& os) const {
  os << "CostModelAbstract {" << *residual_ << ", " << *activation_ << "}";
}

void CostModelResidual::print(std::ostream& os) const {
  os << "CostModelResidual {" << *residual_ << ", " << *activation_ << "}";
}

void CostModelResidual::check(const char* where, const DataPtr& data) const {
  const CostDataAbstract& d = check_data(where, data);
  require(d.of_residual == residual_ && d.of_activation == activation_, where,
          "the data were created by another cost, data of this one's createData() are expected");
}

void CostModelResidual::calc(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef& u) {
  check("CostModelResidual::calc", data);
  residual_->calc(data->residual, x, u);
  activation_->calc(data->activation, data->residual->r);
  data->cost = data->activation->a_value;
}

void CostModelResidual::calc(const DataPtr& data, const ConstVectorRef& x) {
  check("CostModelResidual::calc", data);
  residual_->calc(data->residual, x);
  activation_->calc(data->activation, data->residual->r);
  data->cost = data->activation->a_value;
}

void CostModelResidual::calcDiff(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef& u) {
  check("CostModelResidual::calcDiff", data);
  residual_->calcDiff(data->residual, x, u);
  finish_derivatives(*data, false);
}

void CostModelResidual::calcDiff(const DataPtr& data, const ConstVectorRef& x) {
  check("CostModelResidual::calcDiff", data);
  residual_->calcDiff(data->residual, x);
  finish_derivatives(*data, true);
}

void CostModelResidual::finish_derivatives(CostDataAbstract& data, bool terminal) const {
  residual_->take_whole(*data.residual);
  activation_->calcDiff(data.activation, data.residual->r);
  if (data.Lx.size() == 0) return;
  CostDerivatives d = by_residual(data);
  data.Lx.swap(d.Lx);
  data.Lxx.swap(d.Lxx);
  if (terminal) return;
  data.Lu.swap(d.Lu);
  data.Lxu.swap(d.Lxu);
  data.Luu.swap(d.Luu);
}

}  // namespace manycontact
