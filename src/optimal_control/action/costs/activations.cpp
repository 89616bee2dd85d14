#include <algorithm>
#include <cmath>
#include <limits>

#include "manycontact/action/activation.hpp"

namespace manycontact {

void NamedActivation::check(const char* function, const ConstVectorRef& r) const {
  if (r.size() == static_cast<Eigen::Index>(nr_)) return;
  check_size((std::string(name_) + "::" + function).c_str(), "r", r.size(), nr_);
}

void NamedActivation::calc(const DataPtr& data, const ConstVectorRef& r) {
  check("calc", r);
  data->a_value = value(r);
}

void NamedActivation::calcDiff(const DataPtr& data, const ConstVectorRef& r) {
  check("calcDiff", r);
  differentiate(r, *data);
}

void NamedActivation::print(std::ostream& os) const {
  os << name_ << " {nr=" << nr_;
  print_parameters(os);
  os << "}";
}

double ActivationModelQuad::value(const ConstVectorRef& r) const { return r.squaredNorm() / 2; }

void ActivationModelQuad::differentiate(const ConstVectorRef& r, ActivationDataAbstract& data) const {
  data.Ar = r;
  data.Arr.diagonal().setOnes();
}

double ActivationModelWeightedQuad::value(const ConstVectorRef& r) const { return r.cwiseAbs2().dot(weights_) / 2; }

void ActivationModelWeightedQuad::differentiate(const ConstVectorRef& r, ActivationDataAbstract& data) const {
  data.Ar = weights_.cwiseProduct(r);
  data.Arr.diagonal() = weights_;
}

void ActivationModelWeightedQuad::set_weights(const Eigen::VectorXd& weights) {
  check_size("ActivationModelWeightedQuad::set_weights", "weights", weights.size(), nr_);
  weights_ = weights;
}

ActivationBounds::ActivationBounds(const Eigen::VectorXd& lower, const Eigen::VectorXd& upper, double b)
    : lb(lower), ub(upper), beta(b) {
  const std::string where = "ActivationBounds";
  check_size("ActivationBounds", "ub", ub.size(), lb.size());
  require(beta >= 0 && beta <= 1, where, "beta is " + std::to_string(beta) + ", a number from 0 to 1 is expected");
  const double infinity = std::numeric_limits<double>::infinity();
  for (Eigen::Index i = 0; i < lb.size(); ++i) {
    require(lb[i] <= ub[i] && lb[i] < infinity && ub[i] > -infinity, where,
            "bounds " + std::to_string(i) + " are " + std::to_string(lb[i]) + " and " + std::to_string(ub[i]) +
                ", lb <= ub is expected");
    if (!std::isfinite(lb[i]) || !std::isfinite(ub[i])) continue;
    const double middle = lb[i] + (ub[i] - lb[i]) / 2, half = (ub[i] - lb[i]) / 2;
    if (beta == 1) continue;  // the given bounds remain exact
    lb[i] = middle - beta * half;
    ub[i] = middle + beta * half;
  }
}

namespace {

// Returns the signed distance of r_i from the interval of its bounds: negative below, positive above, zero within.
double outside(const ActivationBounds& b, const ConstVectorRef& r, Eigen::Index i) {
  return std::min(r[i] - b.lb[i], 0.0) + std::max(r[i] - b.ub[i], 0.0);
}
bool is_outside(const ActivationBounds& b, const ConstVectorRef& r, Eigen::Index i) {
  return r[i] <= b.lb[i] || r[i] >= b.ub[i];
}

}  // namespace

double ActivationModelQuadraticBarrier::value(const ConstVectorRef& r) const {
  double sum = 0;
  for (Eigen::Index i = 0; i < r.size(); ++i) {
    const double e = weight(i) * outside(bounds_, r, i);
    sum += e * e / 2;
  }
  return sum;
}

void ActivationModelQuadraticBarrier::differentiate(const ConstVectorRef& r, ActivationDataAbstract& data) const {
  for (Eigen::Index i = 0; i < r.size(); ++i) {
    const double w2 = weight(i) * weight(i);
    data.Ar[i] = w2 * outside(bounds_, r, i);
    data.Arr.diagonal()[i] = is_outside(bounds_, r, i) ? w2 : 0;
  }
}

void ActivationModelQuadraticBarrier::set_bounds(const ActivationBounds& bounds) {
  check_size("ActivationModelQuadraticBarrier::set_bounds", "bounds", bounds.lb.size(), nr_);
  bounds_ = bounds;
}

ActivationModelWeightedQuadraticBarrier::ActivationModelWeightedQuadraticBarrier(const ActivationBounds& bounds,
                                                                                 const Eigen::VectorXd& weights)
    : ActivationModelQuadraticBarrier("ActivationModelWeightedQuadraticBarrier", bounds) {
  check_size(name_, "weights", weights.size(), nr_);
  weights_ = weights;
}

void ActivationModelWeightedQuadraticBarrier::set_weights(const Eigen::VectorXd& weights) {
  check_size("ActivationModelWeightedQuadraticBarrier::set_weights", "weights", weights.size(), nr_);
  weights_ = weights;
}

namespace {

double positive(const std::string& where, const char* what, double number) {
  require(number > 0 && std::isfinite(number), where,
          std::string(what) + " is " + std::to_string(number) + ", a positive number is expected");
  return number;
}

double not_negative(const std::string& where, double alpha) {
  require(alpha >= 0 && std::isfinite(alpha), where,
          "alpha is " + std::to_string(alpha) + ", a number that is not negative is expected");
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

double ActivationModelQuadFlatExp::value(const ConstVectorRef& r) const {
  return -std::expm1(-r.squaredNorm() / alpha_);
}

// The gradient is c r, the Hessian c (I - 2/alpha r r^T), where c = 2/alpha exp(-|r|^2/alpha).
void ActivationModelQuadFlatExp::differentiate(const ConstVectorRef& r, ActivationDataAbstract& data) const {
  const double c = 2 / alpha_ * std::exp(-r.squaredNorm() / alpha_);
  data.Ar = c * r;
  data.Arr.diagonal() = c - 2 * c / alpha_ * r.array().square();
}

double ActivationModelQuadFlatLog::value(const ConstVectorRef& r) const { return std::log1p(r.squaredNorm() / alpha_); }

// The gradient is c r, the Hessian c (I - c r r^T), where c = 2 / (alpha + |r|^2).
void ActivationModelQuadFlatLog::differentiate(const ConstVectorRef& r, ActivationDataAbstract& data) const {
  const double c = 2 / (alpha_ + r.squaredNorm());
  data.Ar = c * r;
  data.Arr.diagonal() = c - c * c * r.array().square();
}

}  // namespace manycontact
