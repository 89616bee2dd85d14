#pragma once
#include <cmath>
#include <span>

namespace manycontact::sparse {

/// Returns the larger of two numbers, or NaN if one of them is NaN.
template <class S>
S larger_or_nan(const S& a, const S& b) {
  return b <= a || a != a ? a : b;
}

inline double largest(std::span<const double> x) {  // NaN if an entry is NaN
  double out = 0;
  for (const double entry : x) out = larger_or_nan(out, std::abs(entry));
  return out;
}

}  // namespace manycontact::sparse
