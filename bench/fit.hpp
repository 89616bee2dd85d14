#pragma once

#include <cmath>
#include <limits>
#include <utility>
#include <vector>

namespace manycontact::bench {

/// Returns p of t ~ size^p by least squares: p = sum (x - mean x)(y - mean y) / sum (x - mean x)^2 with x = log size, y
/// = log t. points: (size, t), all positive. NaN for fewer than two different sizes.
inline double exponent(const std::vector<std::pair<double, double>>& points) {
  double x = 0, y = 0, xx = 0, xy = 0;
  const double n = static_cast<double>(points.size());
  for (const auto& [size, t] : points) x += std::log(size) / n, y += std::log(t) / n;
  for (const auto& [size, t] : points) {
    const double dx = std::log(size) - x;
    xx += dx * dx;
    xy += dx * (std::log(t) - y);
  }
  return xx > 0 ? xy / xx : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace manycontact::bench
