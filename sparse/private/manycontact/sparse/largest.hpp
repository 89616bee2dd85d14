#pragma once
#include <cmath>
#include <span>

namespace manycontact::sparse {

/// The larger of two numbers; NaN where one is.
template <class S>
S larger_or_nan(const S& a, const S& b) {
  return b <= a || a != a ? a : b;
}

/// The largest size of a number in x; NaN where one is; 0 where there is none.
inline double largest(std::span<const double> x) {
  double out = 0;
  for (const double entry : x) out = larger_or_nan(out, std::abs(entry));
  return out;
}

}  // namespace manycontact::sparse
