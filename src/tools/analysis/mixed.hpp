#pragma once
#include <Eigen/Core>
#include <cmath>

namespace manycontact::internal {

/// A test vector of numbers between -1 and 1 that all differ, so that symmetries of a scene do not cancel it.
inline Eigen::VectorXd mixed(Eigen::Index size, int probe) {
  Eigen::VectorXd w(size);
  for (Eigen::Index k = 0; k < size; ++k) w[k] = std::cos(static_cast<double>(k * k + probe * (k + 1)));
  return w;
}

}  // namespace manycontact::internal
