// Activations of |r|: smooth norm, barrier, flat far out.

#include <algorithm>
#include <cmath>
#include <ostream>

#include "manycontact/action/activation.hpp"

namespace manycontact {

using ActivationDataPtr = std::shared_ptr<ActivationDataAbstract>;

namespace {

double positive(const char* who, const char* what, double number) {
  require(number > 0 && std::isfinite(number), who,
          std::string(what) + " is " + std::to_string(number) + ", a positive number expected");
  return number;
}

double not_negative(const char* who, double alpha) {
  require(alpha >= 0 && std::isfinite(alpha), who,
          "alpha is " + std::to_string(alpha) + ", a number that is not negative expected");
  return alpha;
}

}  // namespace

ActivationModelSmooth2Norm::ActivationModelSmooth2Norm(std::size_t nr, double eps)
    : ActivationModelAbstract(nr), eps_(positive("ActivationModelSmooth2Norm", "eps", eps)) {}

void ActivationModelSmooth2Norm::calc(const ActivationDataPtr& data, const ConstVectorRef& r) {
  check_size("ActivationModelSmooth2Norm::calc", "r", r.size(), nr_);
  data->a_value = std::sqrt(eps_ + r.squaredNorm());
}

void ActivationModelSmooth2Norm::calcDiff(const ActivationDataPtr& data, const ConstVectorRef& r) {
  check_size("ActivationModelSmooth2Norm::calcDiff", "r", r.size(), nr_);
  const double a = std::sqrt(eps_ + r.squaredNorm());
  data->Ar = r / a;
  data->Arr.diagonal().setConstant(eps_ / (a * a * a));
}

void ActivationModelSmooth2Norm::print(std::ostream& os) const {
  os << "ActivationModelSmooth2Norm {nr=" << nr_ << ", eps=" << eps_ << "}";
}

ActivationModel2NormBarrier::ActivationModel2NormBarrier(std::size_t nr, double alpha, bool true_hessian)
    : ActivationModelAbstract(nr),
      alpha_(not_negative("ActivationModel2NormBarrier", alpha)),
      true_hessian_(true_hessian) {}

void ActivationModel2NormBarrier::set_alpha(double alpha) {
  alpha_ = not_negative("ActivationModel2NormBarrier::set_alpha", alpha);
}

void ActivationModel2NormBarrier::calc(const ActivationDataPtr& data, const ConstVectorRef& r) {
  check_size("ActivationModel2NormBarrier::calc", "r", r.size(), nr_);
  const double e = std::min(r.norm() - alpha_, 0.0);
  data->a_value = e * e / 2;
}

// With d = |r|: gradient (d - alpha) r / d, Hessian alpha r r^T / d^3 + (d - alpha) / d I.
void ActivationModel2NormBarrier::calcDiff(const ActivationDataPtr& data, const ConstVectorRef& r) {
  check_size("ActivationModel2NormBarrier::calcDiff", "r", r.size(), nr_);
  const double d = r.norm();
  data->Ar.setZero();
  data->Arr.setZero();
  if (d >= alpha_ || d == 0) return;
  data->Ar = (d - alpha_) / d * r;
  for (Eigen::Index i = 0; i < r.size(); ++i) {
    const double along = r[i] / d * (r[i] / d);
    data->Arr.diagonal()[i] = true_hessian_ ? alpha_ / d * along + (d - alpha_) / d : along;
  }
}

void ActivationModel2NormBarrier::print(std::ostream& os) const {
  os << "ActivationModel2NormBarrier {nr=" << nr_ << ", alpha=" << alpha_ << ", Hessian=" << true_hessian_ << "}";
}

ActivationModelQuadFlatExp::ActivationModelQuadFlatExp(std::size_t nr, double alpha)
    : ActivationModelAbstract(nr), alpha_(positive("ActivationModelQuadFlatExp", "alpha", alpha)) {}

void ActivationModelQuadFlatExp::set_alpha(double alpha) {
  alpha_ = positive("ActivationModelQuadFlatExp::set_alpha", "alpha", alpha);
}

void ActivationModelQuadFlatExp::calc(const ActivationDataPtr& data, const ConstVectorRef& r) {
  check_size("ActivationModelQuadFlatExp::calc", "r", r.size(), nr_);
  data->a_value = -std::expm1(-r.squaredNorm() / alpha_);
}

// With c = 2/alpha exp(-|r|^2/alpha): gradient c r, Hessian c (I - 2/alpha r r^T).
void ActivationModelQuadFlatExp::calcDiff(const ActivationDataPtr& data, const ConstVectorRef& r) {
  check_size("ActivationModelQuadFlatExp::calcDiff", "r", r.size(), nr_);
  const double c = 2 / alpha_ * std::exp(-r.squaredNorm() / alpha_);
  data->Ar = c * r;
  data->Arr.diagonal() = c - 2 * c / alpha_ * r.array().square();
}

void ActivationModelQuadFlatExp::print(std::ostream& os) const {
  os << "ActivationModelQuadFlatExp {nr=" << nr_ << ", alpha=" << alpha_ << "}";
}

ActivationModelQuadFlatLog::ActivationModelQuadFlatLog(std::size_t nr, double alpha)
    : ActivationModelAbstract(nr), alpha_(positive("ActivationModelQuadFlatLog", "alpha", alpha)) {}

void ActivationModelQuadFlatLog::set_alpha(double alpha) {
  alpha_ = positive("ActivationModelQuadFlatLog::set_alpha", "alpha", alpha);
}

void ActivationModelQuadFlatLog::calc(const ActivationDataPtr& data, const ConstVectorRef& r) {
  check_size("ActivationModelQuadFlatLog::calc", "r", r.size(), nr_);
  data->a_value = std::log1p(r.squaredNorm() / alpha_);
}

// With c = 2 / (alpha + |r|^2): gradient c r, Hessian c (I - c r r^T).
void ActivationModelQuadFlatLog::calcDiff(const ActivationDataPtr& data, const ConstVectorRef& r) {
  check_size("ActivationModelQuadFlatLog::calcDiff", "r", r.size(), nr_);
  const double c = 2 / (alpha_ + r.squaredNorm());
  data->Ar = c * r;
  data->Arr.diagonal() = c - c * c * r.array().square();
}

void ActivationModelQuadFlatLog::print(std::ostream& os) const {
  os << "ActivationModelQuadFlatLog {nr=" << nr_ << ", alpha=" << alpha_ << "}";
}

}  // namespace manycontact
