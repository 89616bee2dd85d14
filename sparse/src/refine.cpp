#include "manycontact/sparse/refine.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace manycontact::sparse {

double componentwise_backward_error(std::span<const double> r, std::span<const double> scale, double largest) {
  for (double s : scale) largest = std::max(largest, s);
  if (!std::isfinite(largest)) return std::numeric_limits<double>::quiet_NaN();
  const double floor = largest * std::numeric_limits<double>::epsilon();
  double error = 0;
  for (std::size_t k = 0; k < r.size(); ++k) {
    const double e = std::abs(r[k]), bound = std::max(scale[k], floor);
    if (e <= error * bound) continue;
    error = e / bound;
    if (std::isnan(error)) return error;
  }
  return error;
}

}  // namespace manycontact::sparse
