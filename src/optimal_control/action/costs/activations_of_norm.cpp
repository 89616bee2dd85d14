// Smooth norms, and activations of |r|: barrier, flat far out.

#include <algorithm>
#include <cmath>

#include "manycontact/action/activation.hpp"

namespace manycontact {

namespace {

double positive(const std::string& where, const char* what, double number) {
  require(number > 0 && std::isfinite(number), where,
          std::string(what) + " is " + std::to_string(number) + ", a positive number expected");
  return number;
}

double not_negative(const std::string& where, double alpha) {
  require(alpha >= 0 && std::isfinite(alpha), where,
          "alpha is " + std::to_string(alpha) + ", a number that is not negative expected");
  return alpha;
}

}  // namespace

ActivationModelSmooth1Norm::ActivationModelSmooth1Norm(std::size_t nr, double eps)
    : NamedActivation("ActivationModelSmooth1Norm", nr), eps_(positive(name_, "eps", eps)) {}

double ActivationModelSmooth1Norm::value(const ConstVectorRef& r) const {
  return (eps_ + r.array().square()).sqrt().sum();
}

void ActivationModelSmooth1Norm::differentiate(const ConstVectorRef& r, ActivationDataAbstract& data) const {
  for (Eigen::Index i = 0; i < r.size(); ++i) {
    const double a = std::sqrt(eps_ + r[i] * r[i]);
    data.Ar[i] = r[i] / a;
    data.Arr.diagonal()[i] = eps_ / (a * a * a);
  }
}

ActivationModelSmooth2Norm::ActivationModelSmooth2Norm(std::size_t nr, double eps)
    : NamedActivation("ActivationModelSmooth2Norm", nr), eps_(positive(name_, "eps", eps)) {}

double ActivationModelSmooth2Norm::value(const ConstVectorRef& r) const { return std::sqrt(eps_ + r.squaredNorm()); }

void ActivationModelSmooth2Norm::differentiate(const ConstVectorRef& r, ActivationDataAbstract& data) const {
  const double a = value(r);
  data.Ar = r / a;
  data.Arr.diagonal().setConstant(eps_ / (a * a * a));
}

ActivationWithAlpha::ActivationWithAlpha(const char* name, std::size_t nr, double alpha, bool may_be_zero)
    : NamedActivation(name, nr),
      alpha_(may_be_zero ? not_negative(name, alpha) : positive(name, "alpha", alpha)),
      may_be_zero_(may_be_zero) {}

void ActivationWithAlpha::set_alpha(double alpha) {
  const std::string where = std::string(name_) + "::set_alpha";
  alpha_ = may_be_zero_ ? not_negative(where, alpha) : positive(where, "alpha", alpha);
}

ActivationModel2NormBarrier::ActivationModel2NormBarrier(std::size_t nr, double alpha, bool true_hessian)
    : ActivationWithAlpha("ActivationModel2NormBarrier", nr, alpha, true), true_hessian_(true_hessian) {}

void ActivationModel2NormBarrier::print_parameters(std::ostream& os) const {
  ActivationWithAlpha::print_parameters(os);
  os << ", Hessian=" << true_hessian_;
}

double ActivationModel2NormBarrier::value(const ConstVectorRef& r) const {
  const double e = std::min(r.norm() - alpha_, 0.0);
  return e * e / 2;
}

// The gradient is (d - alpha) r / d, the Hessian alpha r r^T / d^3 + (d - alpha) / d I, where d = |r|.
void ActivationModel2NormBarrier::differentiate(const ConstVectorRef& r, ActivationDataAbstract& data) const {
  const double d = r.norm();
  data.Ar.setZero();
  data.Arr.setZero();
  if (d >= alpha_ || d == 0) return;
  data.Ar = (d - alpha_) / d * r;
  for (Eigen::Index i = 0; i < r.size(); ++i) {
    const double along = r[i] / d * (r[i] / d);
    data.Arr.diagonal()[i] = true_hessian_ ? alpha_ / d * along + (d - alpha_) / d : along;
  }
}

ActivationModelQuadFlatExp::ActivationModelQuadFlatExp(std::size_t nr, double alpha)
    : ActivationWithAlpha("ActivationModelQuadFlatExp", nr, alpha, false) {}

double ActivationModelQuadFlatExp::value(const ConstVectorRef& r) const {
  return -std::expm1(-r.squaredNorm() / alpha_);
}

// The gradient is c r, the Hessian c (I - 2/alpha r r^T), where c = 2/alpha exp(-|r|^2/alpha).
void ActivationModelQuadFlatExp::differentiate(const ConstVectorRef& r, ActivationDataAbstract& data) const {
  const double c = 2 / alpha_ * std::exp(-r.squaredNorm() / alpha_);
  data.Ar = c * r;
  data.Arr.diagonal() = c - 2 * c / alpha_ * r.array().square();
}

ActivationModelQuadFlatLog::ActivationModelQuadFlatLog(std::size_t nr, double alpha)
    : ActivationWithAlpha("ActivationModelQuadFlatLog", nr, alpha, false) {}

double ActivationModelQuadFlatLog::value(const ConstVectorRef& r) const { return std::log1p(r.squaredNorm() / alpha_); }

// The gradient is c r, the Hessian c (I - c r r^T), where c = 2 / (alpha + |r|^2).
void ActivationModelQuadFlatLog::differentiate(const ConstVectorRef& r, ActivationDataAbstract& data) const {
  const double c = 2 / (alpha_ + r.squaredNorm());
  data.Ar = c * r;
  data.Arr.diagonal() = c - c * c * r.array().square();
}

}  // namespace manycontact
