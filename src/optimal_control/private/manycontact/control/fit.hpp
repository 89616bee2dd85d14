#pragma once
// Resizes vectors and matrices for the nodes of a problem, and checks numbers. Arrays whose size changes are set to 0.

#include <algorithm>
#include <cmath>

#include "manycontact/control/shooting.hpp"

namespace manycontact::internal {

template <class Matrix>
void fit(Matrix& x, Eigen::Index rows, Eigen::Index cols = 1) {
  if (x.rows() != rows || x.cols() != cols) x.setZero(rows, cols);
}

template <class... Lists>
void fit_all(std::size_t count, std::size_t size, Lists&... lists) {
  (lists.resize(count), ...);
  for (std::size_t t = 0; t < count; ++t) (fit(lists[t], size), ...);
}

/// Resizes each list to one vector per running node, with the node's number of controls.
template <class... Lists>
void fit_controls(const ShootingProblem& problem, Lists&... lists) {
  (lists.resize(problem.get_T()), ...);
  for (std::size_t t = 0; t < problem.get_T(); ++t) (fit(lists[t], problem.model(t)->get_nu()), ...);
}

/// Clamps the controls u to the limits of the node.
inline void keep_limits(const ActionModelAbstract& model, Eigen::VectorXd& u) {
  if (model.get_has_control_limits()) u = u.cwiseMax(model.get_u_lb()).cwiseMin(model.get_u_ub());
}

/// Returns whether all entries are finite and below 1e30 in magnitude.
inline bool is_sound(const Eigen::VectorXd& x) {
  for (const double number : x)
    if (!(std::abs(number) < 1e30)) return false;
  return true;
}

/// Returns the largest magnitude in a list of states or controls, but at least 1.
inline double largest_number(const std::vector<Eigen::VectorXd>& xs) {
  double out = 1;
  for (const Eigen::VectorXd& x : xs)
    if (x.size() > 0) out = std::max(out, x.lpNorm<Eigen::Infinity>());
  return out;
}

}  // namespace manycontact::internal
