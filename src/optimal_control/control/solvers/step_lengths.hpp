#pragma once

#include <cmath>
#include <vector>

#include "manycontact/detail/action/fwd.hpp"

namespace manycontact::internal {

/// Returns the step lengths 1, 1/2, ..., 1/512, as in Crocoddyl.
inline std::vector<double> default_alphas() {
  std::vector<double> alphas;
  for (int n = 0; n < 10; ++n) alphas.push_back(std::ldexp(1, -n));
  return alphas;
}

/// Throws std::invalid_argument unless the step lengths are positive and decreasing.
inline void check_alphas(const char* where, const std::vector<double>& alphas) {
  require(!alphas.empty(), where, "there is no step length, at least one step length is expected");
  for (std::size_t i = 0; i < alphas.size(); ++i)
    require(alphas[i] > 0 && (i == 0 || alphas[i] < alphas[i - 1]), where,
            "step lengths are not positive or do not decrease, positive decreasing step lengths are expected");
}

}  // namespace manycontact::internal
