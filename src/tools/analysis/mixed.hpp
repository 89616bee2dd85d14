#pragma once
#include <Eigen/Core>
#include <cmath>

namespace manycontact::internal {

/// Returns a test vector of distinct numbers between -1 and 1, so that a scene's symmetries do not cancel terms.
inline Eigen::VectorXd mixed(Eigen::Index size, int probe) {
  Eigen::VectorXd w(size);
  for (Eigen::Index k = 0; k < size; ++k) w[k] = std::cos(static_cast<double>(k * k + probe * (k + 1)));
  return w;
}

}  // namespace manycontact::internal
