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

ActivationModelWeightedQuad::ActivationModelWeightedQuad(const Eigen::VectorXd& weights)
    : NamedActivation("ActivationModelWeightedQuad", static_cast<std::size_t>(weights.size())), weights_(weights) {}

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
  require(beta >= 0 && beta <= 1, where, "beta is " + std::to_string(beta) + ", 0 to 1 expected");
  const double infinity = std::numeric_limits<double>::infinity();
  for (Eigen::Index i = 0; i < lb.size(); ++i) {
    require(lb[i] <= ub[i] && lb[i] < infinity && ub[i] > -infinity, where,
            "bounds " + std::to_string(i) + " are " + std::to_string(lb[i]) + " and " + std::to_string(ub[i]) +
                ", lb <= ub expected");
    if (!std::isfinite(lb[i]) || !std::isfinite(ub[i])) continue;
    const double middle = lb[i] + (ub[i] - lb[i]) / 2, half = (ub[i] - lb[i]) / 2;
    if (beta == 1) continue;  // bit for bit what was given
    lb[i] = middle - beta * half;
    ub[i] = middle + beta * half;
  }
}

namespace {

// How far r is outside its bounds, with sign; zero inside.
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

}  // namespace manycontact
