#include "manycontact/action/cones.hpp"

#include <cmath>
#include <numbers>
#include <ostream>

namespace manycontact {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

void require_at_least_zero(double given, const char* where, const char* what) {
  require(given >= 0, where,
          std::string(what) + " is " + std::to_string(given) + ", a number of 0 or more is expected");
}

// Returns the friction coefficient of the facets, which is smaller than mu if the pyramid is inside the cone.
double facet_mu(double mu, std::size_t nf, bool inner) {
  return inner ? mu * std::cos(std::numbers::pi / static_cast<double>(nf)) : mu;
}

// Sets the two rows of +-(moment about `axis`) - side/2 f_z <= 0. They are zero for an infinite side.
template <class Rows>
void pressure_rows(const Eigen::Matrix3d& R, double side, int axis, Rows&& A) {
  A.setZero();
  if (!std::isfinite(side)) return;
  for (int k = 0; k < 2; ++k) {
    A.row(k).template head<3>() = -side / 2 * R.col(2).transpose();
    A.row(k).template tail<3>() = (k == 0 ? 1 : -1) * R.col(axis).transpose();
  }
}

void check_box(const Eigen::Vector2d& box, const char* where) {
  require_at_least_zero(box[0], where, "box[0]");
  require_at_least_zero(box[1], where, "box[1]");
}

}  // namespace

FrictionCone::FrictionCone(const Eigen::Matrix3d& R, double mu, std::size_t nf, bool inner_appr, double min_nforce,
                           double max_nforce)
    : nf_(nf), R_(R), inner_(inner_appr) {
  require(nf > 0 && nf % 2 == 0, "FrictionCone",
          "nf is " + std::to_string(nf) + ", a positive even number of facets is expected");
  set_mu(mu);
  set_min_nforce(min_nforce);
  set_max_nforce(max_nforce);
  A_.setZero(static_cast<Eigen::Index>(nf) + 1, 3);
  lb_.setConstant(A_.rows(), -infinity);
  ub_.setZero(A_.rows());
  update();
}

void FrictionCone::set_mu(double mu) {
  require(mu >= 0 && std::isfinite(mu), "FrictionCone",
          "mu is " + std::to_string(mu) + ", a number of 0 or more is expected");
  mu_ = mu;
}

void FrictionCone::set_min_nforce(double min_nforce) {
  require_at_least_zero(min_nforce, "FrictionCone", "min_nforce");
  min_ = min_nforce;
}

void FrictionCone::set_max_nforce(double max_nforce) {
  require_at_least_zero(max_nforce, "FrictionCone", "max_nforce");
  max_ = max_nforce;
}

void FrictionCone::update() {
  const double mu = facet_mu(mu_, nf_, inner_);
  const Eigen::Index n = static_cast<Eigen::Index>(nf_);
  for (Eigen::Index i = 0; i < n / 2; ++i) {
    // The rows are +-t^T f - mu f_n <= 0, with the i-th tangent t and the normal force f_n.
    const double angle = 2 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(n);
    const Eigen::Vector3d t = std::cos(angle) * R_.col(0) + std::sin(angle) * R_.col(1);
    A_.row(2 * i) = (t - mu * R_.col(2)).transpose();
    A_.row(2 * i + 1) = (-t - mu * R_.col(2)).transpose();
  }
  A_.row(n) = R_.col(2).transpose();
  lb_[n] = min_;
  ub_[n] = max_;
}

std::ostream& operator<<(std::ostream& os, const FrictionCone& cone) {
  return os << "FrictionCone {mu=" << cone.get_mu() << ", nf=" << cone.get_nf() << ", inner=" << cone.get_inner_appr()
            << ", force=" << cone.get_min_nforce() << ".." << cone.get_max_nforce() << "}";
}

WrenchCone::WrenchCone(const Eigen::Matrix3d& R, double mu, const Eigen::Vector2d& box, std::size_t nf, bool inner_appr,
                       double min_nforce, double max_nforce)
    : friction_(R, mu, nf, inner_appr, min_nforce, max_nforce) {
  set_box(box);
  A_.setZero(static_cast<Eigen::Index>(nf) + 13, 6);
  lb_.setConstant(A_.rows(), -infinity);
  ub_.setZero(A_.rows());
  update();
}

void WrenchCone::set_box(const Eigen::Vector2d& box) {
  check_box(box, "WrenchCone");
  box_ = box;
}

void WrenchCone::update() {
  friction_.update();
  const Eigen::Index n = static_cast<Eigen::Index>(get_nf());
  const Eigen::Matrix3d& R = get_R();
  A_.setZero();
  A_.topLeftCorner(n + 1, 3) = friction_.get_A();
  lb_[n] = get_min_nforce();
  ub_[n] = get_max_nforce();
  pressure_rows(R, box_[1], 0, A_.middleRows<2>(n + 1));
  pressure_rows(R, box_[0], 1, A_.middleRows<2>(n + 3));
  // The yaw torque of a rectangular foot (Caron, Pham, Nakamura 2015) has four lower bounds, then four upper bounds.
  const double L = box_[0] / 2, W = box_[1] / 2;
  if (!std::isfinite(L + W)) return;
  const double mu = facet_mu(get_mu(), get_nf(), get_inner_appr());
  for (int k = 0; k < 4; ++k) {
    const double sx = k < 2 ? 1 : -1, sy = k % 2 == 0 ? 1 : -1;
    const Eigen::Vector3d force(sx * W, sy * L, -mu * (L + W)), moment(-sx * mu, -sy * mu, -1);
    A_.row(n + 5 + k) << (R * force).transpose(), (R * moment).transpose();
    A_.row(n + 9 + k) << (R * force).transpose(), -(R * moment).transpose();
  }
}

std::ostream& operator<<(std::ostream& os, const WrenchCone& cone) {
  return os << "WrenchCone {mu=" << cone.get_mu() << ", box=" << cone.get_box().transpose() << ", nf=" << cone.get_nf()
            << ", inner=" << cone.get_inner_appr() << ", force=" << cone.get_min_nforce() << ".."
            << cone.get_max_nforce() << "}";
}

CoPSupport::CoPSupport(const Eigen::Matrix3d& R, const Eigen::Vector2d& box) : R_(R) {
  set_box(box);
  lb_.setConstant(-infinity);
  ub_.setZero();
  update();
}

void CoPSupport::set_box(const Eigen::Vector2d& box) {
  check_box(box, "CoPSupport");
  box_ = box;
}

void CoPSupport::update() {
  pressure_rows(R_, box_[1], 0, A_.topRows<2>());
  pressure_rows(R_, box_[0], 1, A_.bottomRows<2>());
}

std::ostream& operator<<(std::ostream& os, const CoPSupport& support) {
  return os << "CoPSupport {box=" << support.get_box().transpose() << "}";
}

}  // namespace manycontact
