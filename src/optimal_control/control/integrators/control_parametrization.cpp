#include "manycontact/control/control_parametrization.hpp"

#include "../../action/assign.hpp"

namespace manycontact {

using Poly = ControlParametrizationModelPoly;
using ConstMatrixRef = Eigen::Ref<const Eigen::MatrixXd>;

ControlParametrizationDataAbstract::ControlParametrizationDataAbstract(const ControlParametrizationModelAbstract* model)
    : w(Eigen::VectorXd::Zero(model->get_nw())),
      u(Eigen::VectorXd::Zero(model->get_nu())),
      dw_du(Eigen::MatrixXd::Zero(model->get_nw(), model->get_nu())) {}

ControlParametrizationModelAbstract::Data ControlParametrizationModelAbstract::createData() {
  return std::make_shared<ControlParametrizationDataAbstract>(this);
}

bool ControlParametrizationModelAbstract::checkData(const Data& data) { return data != nullptr; }

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

namespace {

ControlParametrizationDataPoly& own(const char* where, const Poly::Data& data) {
  auto* d = dynamic_cast<ControlParametrizationDataPoly*>(&check_data(where, data));
  require(d != nullptr, where, "the data were created by another model, data of this one's createData() are expected");
  return *d;
}

}  // namespace

void Poly::calc(const Data& data, double t, const ConstVectorRef& u) const {
  check_size("ControlParametrizationModel::calc", "u", u.size(), nu_);
  ControlParametrizationDataPoly& d = own("ControlParametrizationModel::calc", data);
  d.c = coefficients(t);
  d.w = d.c[0] * u.head(nw_);
  for (std::size_t k = 1; k < terms_; ++k) d.w += d.c[k] * u.segment(k * nw_, nw_);
}

void Poly::calcDiff(const Data& data, double, const ConstVectorRef&) const {
  const ControlParametrizationDataPoly& d = own("ControlParametrizationModel::calcDiff", data);
  for (std::size_t k = 0; k < terms_; ++k) data->dw_du.middleCols(k * nw_, nw_).diagonal().setConstant(d.c[k]);
}

Poly::Data Poly::createData() {
  auto data = std::make_shared<ControlParametrizationDataPoly>(this);
  data->c[0] = 1;
  data->dw_du.leftCols(nw_).setIdentity();
  return data;
}

bool Poly::checkData(const Data& data) { return dynamic_cast<ControlParametrizationDataPoly*>(data.get()) != nullptr; }

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
  const ControlParametrizationDataPoly& d = own(kWhere, data);
  for (std::size_t k = 0; k < terms_; ++k) internal::assign(out.middleCols(k * nw_, nw_), d.c[k] * A, op);
}

void Poly::multiplyJacobianTransposeBy(const Data& data, const ConstMatrixRef& A, MatrixRef out,
                                       AssignmentOp op) const {
  constexpr const char* kWhere = "ControlParametrizationModel::multiplyJacobianTransposeBy";
  check_size(kWhere, "a column of A", A.rows(), nw_);
  check_size(kWhere, "a column of out", out.rows(), nu_);
  check_size(kWhere, "a row of out", out.cols(), A.cols());
  const ControlParametrizationDataPoly& d = own(kWhere, data);
  for (std::size_t k = 0; k < terms_; ++k) internal::assign(out.middleRows(k * nw_, nw_), d.c[k] * A, op);
}

ControlParametrizationModelPolyTwoRK::ControlParametrizationModelPolyTwoRK(std::size_t nw, RKType rktype)
    : ControlParametrizationModelPoly(nw, 3), rktype_(rktype) {
  require(rktype == three || rktype == four, "ControlParametrizationModelPolyTwoRK",
          "the two stages of rktype two do not determine a quadratic, rktype three or four is expected");
}

// Lagrange's polynomials of the times 0, 1/3, 2/3 and 0, 1/2, 1.
std::array<double, 3> ControlParametrizationModelPolyTwoRK::coefficients(double t) const {
  if (rktype_ == three) return {4.5 * (t * t - t) + 1, -9 * t * t + 6 * t, 4.5 * t * t - 1.5 * t};
  return {2 * t * t - 3 * t + 1, 4 * (t - t * t), 2 * t * t - t};
}

}  // namespace manycontact
