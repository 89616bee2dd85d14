#include "manycontact/detail/control/state_vector.hpp"

#include <random>

namespace manycontact {

namespace {

void add_identity(MatrixRef J, double sign, AssignmentOp op) {
  if (op == setto) J.setZero();
  J.diagonal().array() += op == rmfrom ? -sign : sign;
}

}  // namespace

Eigen::VectorXd StateVector::rand() const {
  thread_local std::mt19937 rng(1);
  Eigen::VectorXd x(nx_);
  for (double& number : x) number = std::uniform_real_distribution<double>(-1, 1)(rng);
  return x;
}

void StateVector::diff(const ConstVectorRef& x0, const ConstVectorRef& x1, VectorRef dx) const {
  check_size("StateVector::diff", "x0", x0.size(), nx_);
  check_size("StateVector::diff", "x1", x1.size(), nx_);
  check_size("StateVector::diff", "dxout", dx.size(), nx_);
  dx = x1 - x0;
}

void StateVector::integrate(const ConstVectorRef& x, const ConstVectorRef& dx, VectorRef out) const {
  check_size("StateVector::integrate", "x", x.size(), nx_);
  check_size("StateVector::integrate", "dx", dx.size(), nx_);
  check_size("StateVector::integrate", "xout", out.size(), nx_);
  out = x + dx;
}

void StateVector::Jdiff(const ConstVectorRef&, const ConstVectorRef&, MatrixRef Jfirst, MatrixRef Jsecond,
                        Jcomponent which) const {
  if (which != second) add_identity(Jfirst, -1, setto);
  if (which != first) add_identity(Jsecond, 1, setto);
}

void StateVector::Jintegrate(const ConstVectorRef&, const ConstVectorRef&, MatrixRef Jfirst, MatrixRef Jsecond,
                             Jcomponent which, AssignmentOp op) const {
  if (which != second) add_identity(Jfirst, 1, op);
  if (which != first) add_identity(Jsecond, 1, op);
}

void StateVector::JintegrateTransport(const ConstVectorRef&, const ConstVectorRef&, MatrixRef, Jcomponent which) const {
  require(which != both, "StateVector::JintegrateTransport", "firstsecond is `both`, first or second is expected");
}

}  // namespace manycontact
