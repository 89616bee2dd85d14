#include "manycontact/action/cost.hpp"

#include <algorithm>
#include <ostream>

namespace manycontact {

CostDataResidual::CostDataResidual(CostModelResidual* model, DataCollector* shared)
    : of_residual(model->get_residual()),
      of_activation(model->get_activation()),
      activation(model->get_activation()->createData()),
      residual(model->get_residual()->createData(shared)) {}

CostModelResidual::CostModelResidual(std::shared_ptr<StateMultibody> state,
                                     std::shared_ptr<ActivationModelAbstract> activation,
                                     std::shared_ptr<ResidualModelAbstract> residual)
    : state_(std::move(state)), activation_(std::move(activation)), residual_(std::move(residual)) {
  require(state_ && activation_ && residual_, "CostModelResidual",
          "a null pointer was given, a state, an activation and a residual are expected");
  require(residual_->get_state() == state_, "CostModelResidual",
          "the residual belongs to another state, this one's is expected");
  require(activation_->get_nr() == residual_->get_nr(), "CostModelResidual",
          "the activation has nr = " + std::to_string(activation_->get_nr()) + ", the residual's " +
              std::to_string(residual_->get_nr()) + " is expected");
}

CostModelResidual::CostModelResidual(std::shared_ptr<StateMultibody> state,
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
  activation_->calcDiff(data->activation, data->residual->r);
  form_hessians(*data);
}

void CostModelResidual::calcDiff(const std::shared_ptr<CostDataResidual>& data, const ConstVectorRef& x) {
  check("CostModelResidual::calcDiff", data);
  residual_->calcDiff(data->residual, x);
  activation_->calcDiff(data->activation, data->residual->r);
  form_hessians(*data);
}

namespace {

// out = L^T R in pieces whose workspace Eigen takes from the stack.
void transposed_product(const Eigen::MatrixXd& L, const Eigen::MatrixXd& R, Eigen::MatrixXd& out) {
  constexpr Eigen::Index kTile = 48, kDepth = 256;
  out.resize(L.cols(), R.cols());
  if (out.size() == 1 && L.rows() == 1) {
    out(0, 0) = L(0, 0) * R(0, 0);
    return;
  }
  out.setZero();
  for (Eigen::Index k = 0; k < L.rows(); k += kDepth)
    for (Eigen::Index j = 0; j < R.cols(); j += kTile)
      for (Eigen::Index i = 0; i < L.cols(); i += kTile) {
        const Eigen::Index d = std::min(kDepth, L.rows() - k), m = std::min(kTile, L.cols() - i),
                           n = std::min(kTile, R.cols() - j);
        out.block(i, j, m, n).noalias() += L.block(k, i, d, m).transpose() * R.block(k, j, d, n);
      }
}

}  // namespace

void CostModelResidual::form_hessians(CostDataResidual& data) const {
  const std::vector<ResidualBlock>& blocks = data.residual->blocks;
  data.hessians.resize(blocks.size());
  const auto& A = data.activation->Arr.diagonal();
  for (std::size_t k = 0; k < blocks.size(); ++k) {
    const ResidualBlock& b = blocks[k];
    CostDataResidual::Hessian& h = data.hessians[k];
    h.ARx.resize(b.rows.size(), b.xcols.size());
    h.ARu.resize(b.rows.size(), b.ucols.size());
    for (std::size_t i = 0; i < b.rows.size(); ++i) {
      h.ARx.row(i) = A[b.rows[i]] * b.Rx.row(i);
      h.ARu.row(i) = A[b.rows[i]] * b.Ru.row(i);
    }
    transposed_product(b.Rx, h.ARx, h.xx);
    transposed_product(b.Rx, h.ARu, h.xu);
    transposed_product(b.Ru, h.ARu, h.uu);
  }
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
