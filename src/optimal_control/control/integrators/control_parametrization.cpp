#include "manycontact/control/control_parametrization.hpp"

#include "../../action/assign.hpp"
#include "../../action/differences.hpp"

namespace manycontact {

using Poly = ControlParametrizationModelPoly;
using NumDiff = ControlParametrizationModelNumDiff;
using ConstMatrixRef = Eigen::Ref<const Eigen::MatrixXd>;

ControlParametrizationDataAbstract::ControlParametrizationDataAbstract(const ControlParametrizationModelAbstract* model)
    : w(Eigen::VectorXd::Zero(model->get_nw())),
      u(Eigen::VectorXd::Zero(model->get_nu())),
      dw_du(Eigen::MatrixXd::Zero(model->get_nw(), model->get_nu())) {}

Eigen::MatrixXd ControlParametrizationModelAbstract::multiplyByJacobian_J(const Data& data,
                                                                          const ConstMatrixRef& A) const {
  Eigen::MatrixXd out(A.rows(), nu_);
  multiplyByJacobian(data, A, out);
  return out;
}

Eigen::MatrixXd ControlParametrizationModelAbstract::multiplyJacobianTransposeBy_J(const Data& data,
                                                                                   const ConstMatrixRef& A) const {
  Eigen::MatrixXd out(nu_, A.cols());
  multiplyJacobianTransposeBy(data, A, out);
  return out;
}

void Poly::calc(const Data& data, double t, const ConstVectorRef& u) const {
  check_size("ControlParametrizationModel::calc", "u", u.size(), nu_);
  ControlParametrizationDataPoly& d =
      internal::own_data<ControlParametrizationDataPoly>("ControlParametrizationModel::calc", data);
  d.c = coefficients(t);
  d.w = d.c[0] * u.head(nw_);
  for (std::size_t k = 1; k < terms_; ++k) d.w += d.c[k] * u.segment(k * nw_, nw_);
}

void Poly::calcDiff(const Data& data, double, const ConstVectorRef&) const {
  const ControlParametrizationDataPoly& d =
      internal::own_data<ControlParametrizationDataPoly>("ControlParametrizationModel::calcDiff", data);
  for (std::size_t k = 0; k < terms_; ++k) data->dw_du.middleCols(k * nw_, nw_).diagonal().setConstant(d.c[k]);
}

Poly::Data Poly::createData() {
  auto data = std::make_shared<ControlParametrizationDataPoly>(this);
  data->c[0] = 1;
  data->dw_du.leftCols(nw_).setIdentity();
  return data;
}

void Poly::params(const Data& data, double, const ConstVectorRef& w) const {
  check_size("ControlParametrizationModel::params", "w", w.size(), nw_);
  for (std::size_t k = 0; k < terms_; ++k) check_data("params", data).u.segment(k * nw_, nw_) = w;
}

void Poly::convertBounds(const ConstVectorRef& w_lb, const ConstVectorRef& w_ub, VectorRef u_lb, VectorRef u_ub) const {
  constexpr const char* kWhere = "ControlParametrizationModel::convertBounds";
  check_size(kWhere, "w_lb", w_lb.size(), nw_);
  check_size(kWhere, "w_ub", w_ub.size(), nw_);
  check_size(kWhere, "u_lb", u_lb.size(), nu_);
  check_size(kWhere, "u_ub", u_ub.size(), nu_);
  for (std::size_t k = 0; k < terms_; ++k) {
    u_lb.segment(k * nw_, nw_) = w_lb;
    u_ub.segment(k * nw_, nw_) = w_ub;
  }
}

void Poly::multiplyByJacobian(const Data& data, const ConstMatrixRef& A, MatrixRef out, AssignmentOp op) const {
  constexpr const char* kWhere = "ControlParametrizationModel::multiplyByJacobian";
  check_size(kWhere, "a row of A", A.cols(), nw_);
  check_size(kWhere, "a row of out", out.cols(), nu_);
  check_size(kWhere, "a column of out", out.rows(), A.rows());
  const ControlParametrizationDataPoly& d = internal::own_data<ControlParametrizationDataPoly>(kWhere, data);
  for (std::size_t k = 0; k < terms_; ++k) internal::assign(out.middleCols(k * nw_, nw_), d.c[k] * A, op);
}

void Poly::multiplyJacobianTransposeBy(const Data& data, const ConstMatrixRef& A, MatrixRef out,
                                       AssignmentOp op) const {
  constexpr const char* kWhere = "ControlParametrizationModel::multiplyJacobianTransposeBy";
  check_size(kWhere, "a column of A", A.rows(), nw_);
  check_size(kWhere, "a column of out", out.rows(), nu_);
  check_size(kWhere, "a row of out", out.cols(), A.cols());
  const ControlParametrizationDataPoly& d = internal::own_data<ControlParametrizationDataPoly>(kWhere, data);
  for (std::size_t k = 0; k < terms_; ++k) internal::assign(out.middleRows(k * nw_, nw_), d.c[k] * A, op);
}

ControlParametrizationModelPolyTwoRK::ControlParametrizationModelPolyTwoRK(std::size_t nw, RKType rktype)
    : ControlParametrizationModelPoly(nw, 3), rktype_(rktype) {
  require(rktype == three || rktype == four, "ControlParametrizationModelPolyTwoRK",
          "the two stages of rktype two do not determine a quadratic, rktype three or four is expected");
}

// Returns the Lagrange polynomials at t for the nodes 0, 1/3, 2/3 (three stages) or 0, 1/2, 1 (four stages).
std::array<double, 3> ControlParametrizationModelPolyTwoRK::coefficients(double t) const {
  if (rktype_ == three) return {4.5 * (t * t - t) + 1, -9 * t * t + 6 * t, 4.5 * t * t - 1.5 * t};
  return {2 * t * t - 3 * t + 1, 4 * (t - t * t), 2 * t * t - t};
}

namespace {

constexpr const char* kControlNumDiff = "ControlParametrizationModelNumDiff";

ControlParametrizationDataNumDiff& own(const NumDiff::Data& data) {
  return internal::own_data<ControlParametrizationDataNumDiff>(kControlNumDiff, data);
}

}  // namespace

NumDiff::Data NumDiff::createData() { return std::make_shared<ControlParametrizationDataNumDiff>(this); }

void NumDiff::calc(const Data& data, double t, const ConstVectorRef& u) const {
  auto& d = own(data);
  model_->calc(d.data_0, t, u);
  d.w = d.data_0->w;
}

void NumDiff::calcDiff(const Data& data, double t, const ConstVectorRef& u) const {
  auto& d = own(data);
  d.dw_du = internal::jacobian_by_u(static_cast<Eigen::Index>(nw_), u, step_, [&](const Eigen::VectorXd& at) {
    model_->calc(d.data_0, t, at);
    return d.data_0->w;
  });
  calc(data, t, u);
}

void NumDiff::params(const Data& data, double t, const ConstVectorRef& w) const {
  auto& d = own(data);
  model_->params(d.data_0, t, w);
  d.u = d.data_0->u;
}

void NumDiff::multiplyByJacobian(const Data& data, const ConstMatrixRef& A, MatrixRef out, AssignmentOp op) const {
  internal::assign(out, A * own(data).dw_du, op);
}

void NumDiff::multiplyJacobianTransposeBy(const Data& data, const ConstMatrixRef& A, MatrixRef out,
                                          AssignmentOp op) const {
  internal::assign(out, own(data).dw_du.transpose() * A, op);
}

}  // namespace manycontact
