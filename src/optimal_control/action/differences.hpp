#pragma once

#include "manycontact/action/state.hpp"

namespace manycontact::internal {

/// Calls column(i, f(d), f(-d), 2h) for each of n directions i, where d is h times the unit vector i.
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

/// Returns the Jacobian (rows x n) of f at zero by central differences with step h.
template <class F>
Eigen::MatrixXd jacobian(Eigen::Index rows, Eigen::Index n, double h, F&& f) {
  Eigen::MatrixXd J(rows, n);
  each_direction(n, h, f, [&](Eigen::Index i, const Eigen::VectorXd& plus, const Eigen::VectorXd& minus, double width) {
    J.col(i) = (plus - minus) / width;
  });
  return J;
}

/// Returns the Jacobian (rows x nu) of f at u by central differences with the steps h max(1, |u_i|).
template <class F>
Eigen::MatrixXd jacobian_by_u(Eigen::Index rows, const Eigen::VectorXd& u, double h, F&& f) {
  const Eigen::VectorXd scale = u.cwiseAbs().cwiseMax(1);
  return jacobian(rows, u.size(), h, [&](const Eigen::VectorXd& d) { return f(u + scale.cwiseProduct(d)); }) *
         scale.cwiseInverse().asDiagonal();
}

}  // namespace manycontact::internal
