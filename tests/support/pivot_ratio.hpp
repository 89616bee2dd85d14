#pragma once
#include <cmath>

namespace manycontact::test {

/// Returns min over k of |D_k| / terms_k, the rest of a pivot after cancellation; 0 if one is not finite.
inline double smallest_pivot_ratio(int n, const double* D, const double* terms) {
  double ratio = 1;
  for (int k = 0; k < n; ++k) {
    const double d = std::abs(D[k]);
    if (!(d >= ratio * terms[k])) ratio = d > 0 && std::isfinite(terms[k]) ? d / terms[k] : 0;
  }
  return ratio;
}

}  // namespace manycontact::test
