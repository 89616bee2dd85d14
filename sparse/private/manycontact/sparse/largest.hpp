#pragma once

namespace manycontact::sparse {

/// The larger of two numbers; NaN where one is.
template <class S>
S larger_or_nan(const S& a, const S& b) {
  return b <= a || a != a ? a : b;
}

}  // namespace manycontact::sparse
