#include "newton_step.hpp"

#include <cmath>

namespace manycontact::internal {

namespace {

// Returns the largest alpha <= most with x + alpha p within the bounds; `stopped`: coordinate at its bound, or -1.
double way_to_limit(const Eigen::VectorXd& x, const Eigen::VectorXd& p, const Eigen::VectorXd& lower,
                    const Eigen::VectorXd& upper, double most, Eigen::Index& stopped) {
  stopped = -1;
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    if (p[i] == 0) continue;
    const double way = ((p[i] > 0 ? upper[i] : lower[i]) - x[i]) / p[i];
    if (way < most) most = way, stopped = i;
  }
  return most;
}

}  // namespace

// Computes z = (J^T J + mu 1)^-1 r in the free coordinates, as (r - J^T (J J^T + mu 1)^-1 J r) / mu.
void NewtonStep::precondition(const Eigen::SparseMatrix<double>& J, double mu, const Eigen::VectorXd& r,
                              Eigen::VectorXd& z) {
  z = r;
  for (Eigen::Index i = 0; i < z.size(); ++i)
    if (!free_[i]) z[i] = 0;
  Eigen::VectorXd y = J * z;
  normal_.solve(y);
  z = (z - J.transpose() * y) / mu;
  for (Eigen::Index i = 0; i < z.size(); ++i)
    if (!free_[i]) z[i] = 0;
}

// Below, H is the Hessian of |e|^2 / 2, g its gradient at x = 0, and r = -(g + H x). From 0 to x, the quadratic model
// decreases by
//     (r - g)^T x / 2
double NewtonStep::solve(const Eigen::SparseMatrix<double>& J, double size_of_e, const Gradient& gradient,
                         const Eigen::VectorXd& lower, const Eigen::VectorXd& upper, Eigen::VectorXd& x) {
  constexpr double kDifference = 1e-6;  // step of finite differences [rad, m]; relative error of Hessian products
  constexpr double kSolved = 1e-3;      // the iteration ends if |r| is below this, relative to |g|
  const Eigen::Index n = J.cols();
  const Eigen::VectorXd g = gradient(Eigen::VectorXd::Zero(n));
  Eigen::VectorXd r = -g, z, p, Hp;
  x.setZero(n);
  free_.assign(static_cast<std::size_t>(n), 1);
  double wanted = 0;
  for (Eigen::Index i = 0; i < n; ++i) {
    const double room = g[i] > 0 ? -lower[i] : upper[i];
    free_[i] = g[i] != 0 && room > 0;
    if (free_[i]) wanted = std::max(wanted, kSolved * std::abs(g[i]));
  }
  bool begins = true;
  double rz = 0;
  for (Eigen::Index product = 0; product < 2 * n; ++product) {
    if (begins) normal_.factorize(J, free_, size_of_e);
    precondition(J, size_of_e, r, z);
    const double now = r.dot(z);
    p = begins ? z : Eigen::VectorXd(z + now / rz * p);
    rz = now;
    const double length = p.lpNorm<Eigen::Infinity>();
    if (!(length > 0) || !(rz > 0)) break;
    Hp = (gradient(kDifference / length * p) - g) * (length / kDifference);
    const double curvature = p.dot(Hp);
    Eigen::Index stopped;
    const double alpha = way_to_limit(
        x, p, lower, upper, curvature > 0 ? rz / curvature : std::numeric_limits<double>::infinity(), stopped);
    x += alpha * p;
    r -= alpha * Hp;
    begins = stopped >= 0;
    if (begins) {
      x[stopped] = p[stopped] > 0 ? upper[stopped] : lower[stopped];
      free_[stopped] = 0;
    }
    double left = 0;
    for (Eigen::Index i = 0; i < n; ++i)
      if (free_[i]) left = std::max(left, std::abs(r[i]));
    if (left <= wanted) break;
  }
  x = x.cwiseMax(lower).cwiseMin(upper);
  return 0.5 * (r - g).dot(x);
}

}  // namespace manycontact::internal
