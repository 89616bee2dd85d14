#pragma once
// Jacobians of functions by central differences.

#include "manycontact/action/state.hpp"

namespace manycontact::internal {

/// column(i, (f(+) - f(-)) / 2h) for each of n directions; f(step of direction i), column(i, f(+), f(-), 2h).
template <class F, class Column>
void each_direction(Eigen::Index n, double h, F&& f, Column&& column) {
  for (Eigen::Index i = 0; i < n; ++i) {
    Eigen::VectorXd d = Eigen::VectorXd::Zero(n);
    d[i] = h;
    const auto plus = f(d);
    const auto minus = f(-d);
    column(i, plus, minus, 2 * h);
  }
}

/// The Jacobian of a function of n numbers.
template <class F>
Eigen::MatrixXd jacobian(Eigen::Index rows, Eigen::Index n, double h, F&& f) {
  Eigen::MatrixXd J(rows, n);
  each_direction(n, h, f, [&](Eigen::Index i, const Eigen::VectorXd& plus, const Eigen::VectorXd& minus, double width) {
    J.col(i) = (plus - minus) / width;
  });
  return J;
}

/// Computes the differences with respect to u; the steps are relative to u.
template <class F>
Eigen::MatrixXd jacobian_by_u(Eigen::Index rows, const Eigen::VectorXd& u, double h, F&& f) {
  const Eigen::VectorXd scale = u.cwiseAbs().cwiseMax(1);
  return jacobian(rows, u.size(), h, [&](const Eigen::VectorXd& d) { return f(u + scale.cwiseProduct(d)); }) *
         scale.cwiseInverse().asDiagonal();
}

}  // namespace manycontact::internal
