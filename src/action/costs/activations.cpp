#include <algorithm>
#include <cmath>
#include <limits>
#include <ostream>

#include "manycontact/action/activation.hpp"

namespace manycontact {

void ActivationModelAbstract::print(std::ostream& os) const { os << "ActivationModel {nr=" << nr_ << "}"; }

void ActivationModelQuad::calc(const std::shared_ptr<ActivationDataAbstract>& data, const ConstVectorRef& r) {
  check_size("ActivationModelQuad::calc", "r", r.size(), nr_);
  data->a_value = r.squaredNorm() / 2;
}

void ActivationModelQuad::calcDiff(const std::shared_ptr<ActivationDataAbstract>& data, const ConstVectorRef& r) {
  check_size("ActivationModelQuad::calcDiff", "r", r.size(), nr_);
  data->Ar = r;
  data->Arr.diagonal().setOnes();
}

void ActivationModelQuad::print(std::ostream& os) const { os << "ActivationModelQuad {nr=" << nr_ << "}"; }

ActivationModelWeightedQuad::ActivationModelWeightedQuad(const Eigen::VectorXd& weights)
    : ActivationModelAbstract(weights.size()), weights_(weights) {}

void ActivationModelWeightedQuad::calc(const std::shared_ptr<ActivationDataAbstract>& data, const ConstVectorRef& r) {
  check_size("ActivationModelWeightedQuad::calc", "r", r.size(), nr_);
  data->a_value = r.cwiseAbs2().dot(weights_) / 2;
}

void ActivationModelWeightedQuad::calcDiff(const std::shared_ptr<ActivationDataAbstract>& data,
                                           const ConstVectorRef& r) {
  check_size("ActivationModelWeightedQuad::calcDiff", "r", r.size(), nr_);
  data->Ar = weights_.cwiseProduct(r);
  data->Arr.diagonal() = weights_;
}

void ActivationModelWeightedQuad::set_weights(const Eigen::VectorXd& weights) {
  check_size("ActivationModelWeightedQuad::set_weights", "weights", weights.size(), nr_);
  weights_ = weights;
}

void ActivationModelWeightedQuad::print(std::ostream& os) const {
  os << "ActivationModelWeightedQuad {nr=" << nr_ << "}";
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

void ActivationModelQuadraticBarrier::calc(const std::shared_ptr<ActivationDataAbstract>& data,
                                           const ConstVectorRef& r) {
  check_size("ActivationModelQuadraticBarrier::calc", "r", r.size(), nr_);
  data->a_value = 0;
  for (Eigen::Index i = 0; i < r.size(); ++i) {
    const double e = outside(bounds_, r, i);
    data->a_value += e * e / 2;
  }
}

void ActivationModelQuadraticBarrier::calcDiff(const std::shared_ptr<ActivationDataAbstract>& data,
                                               const ConstVectorRef& r) {
  check_size("ActivationModelQuadraticBarrier::calcDiff", "r", r.size(), nr_);
  for (Eigen::Index i = 0; i < r.size(); ++i) {
    data->Ar[i] = outside(bounds_, r, i);
    data->Arr.diagonal()[i] = is_outside(bounds_, r, i) ? 1 : 0;
  }
}

void ActivationModelQuadraticBarrier::set_bounds(const ActivationBounds& bounds) {
  check_size("ActivationModelQuadraticBarrier::set_bounds", "bounds", bounds.lb.size(), nr_);
  bounds_ = bounds;
}

void ActivationModelQuadraticBarrier::print(std::ostream& os) const {
  os << "ActivationModelQuadraticBarrier {nr=" << nr_ << "}";
}

ActivationModelWeightedQuadraticBarrier::ActivationModelWeightedQuadraticBarrier(const ActivationBounds& bounds,
                                                                                 const Eigen::VectorXd& weights)
    : ActivationModelQuadraticBarrier(bounds) {
  check_size("ActivationModelWeightedQuadraticBarrier", "weights", weights.size(), nr_);
  weights_ = weights;
}

void ActivationModelWeightedQuadraticBarrier::calc(const std::shared_ptr<ActivationDataAbstract>& data,
                                                   const ConstVectorRef& r) {
  check_size("ActivationModelWeightedQuadraticBarrier::calc", "r", r.size(), nr_);
  data->a_value = 0;
  for (Eigen::Index i = 0; i < r.size(); ++i) {
    const double e = weights_[i] * outside(bounds_, r, i);
    data->a_value += e * e / 2;
  }
}

void ActivationModelWeightedQuadraticBarrier::calcDiff(const std::shared_ptr<ActivationDataAbstract>& data,
                                                       const ConstVectorRef& r) {
  check_size("ActivationModelWeightedQuadraticBarrier::calcDiff", "r", r.size(), nr_);
  for (Eigen::Index i = 0; i < r.size(); ++i) {
    const double w2 = weights_[i] * weights_[i];
    data->Ar[i] = w2 * outside(bounds_, r, i);
    data->Arr.diagonal()[i] = is_outside(bounds_, r, i) ? w2 : 0;
  }
}

void ActivationModelWeightedQuadraticBarrier::set_weights(const Eigen::VectorXd& weights) {
  check_size("ActivationModelWeightedQuadraticBarrier::set_weights", "weights", weights.size(), nr_);
  weights_ = weights;
}

void ActivationModelWeightedQuadraticBarrier::print(std::ostream& os) const {
  os << "ActivationModelWeightedQuadraticBarrier {nr=" << nr_ << "}";
}

ActivationModelSmooth1Norm::ActivationModelSmooth1Norm(std::size_t nr, double eps)
    : ActivationModelAbstract(nr), eps_(eps) {
  require(eps > 0 && std::isfinite(eps), "ActivationModelSmooth1Norm",
          "eps is " + std::to_string(eps) + ", a positive number expected");
}

void ActivationModelSmooth1Norm::calc(const std::shared_ptr<ActivationDataAbstract>& data, const ConstVectorRef& r) {
  check_size("ActivationModelSmooth1Norm::calc", "r", r.size(), nr_);
  data->a_value = (eps_ + r.array().square()).sqrt().sum();
}

void ActivationModelSmooth1Norm::calcDiff(const std::shared_ptr<ActivationDataAbstract>& data,
                                          const ConstVectorRef& r) {
  check_size("ActivationModelSmooth1Norm::calcDiff", "r", r.size(), nr_);
  for (Eigen::Index i = 0; i < r.size(); ++i) {
    const double a = std::sqrt(eps_ + r[i] * r[i]);
    data->Ar[i] = r[i] / a;
    data->Arr.diagonal()[i] = eps_ / (a * a * a);
  }
}

void ActivationModelSmooth1Norm::print(std::ostream& os) const {
  os << "ActivationModelSmooth1Norm {nr=" << nr_ << ", eps=" << eps_ << "}";
}

}  // namespace manycontact
