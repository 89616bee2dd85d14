#pragma once
// A pack of four doubles, element by element, on which tests instantiate kernels for SIMD batches.

#include "manycontact/sparse/ldl_kernels.hpp"

namespace manycontact::test {

struct FourLanes {
  double v[4] = {};

  FourLanes() = default;
  explicit FourLanes(double x) : v{x, x, x, x} {}
  double& operator[](int k) { return v[k]; }
  double operator[](int k) const { return v[k]; }
};

template <class F>
FourLanes by_lane(F&& f) {
  FourLanes out;
  for (int k = 0; k < 4; ++k) out[k] = f(k);
  return out;
}
inline FourLanes operator+(const FourLanes& a, const FourLanes& b) {
  return by_lane([&](int k) { return a[k] + b[k]; });
}
inline FourLanes operator-(const FourLanes& a, const FourLanes& b) {
  return by_lane([&](int k) { return a[k] - b[k]; });
}
inline FourLanes operator*(const FourLanes& a, const FourLanes& b) {
  return by_lane([&](int k) { return a[k] * b[k]; });
}
inline FourLanes operator/(const FourLanes& a, const FourLanes& b) {
  return by_lane([&](int k) { return a[k] / b[k]; });
}
inline FourLanes operator-(const FourLanes& a) {
  return by_lane([&](int k) { return -a[k]; });
}
inline FourLanes multiply_add(const FourLanes& a, const FourLanes& b, const FourLanes& c) {
  return by_lane([&](int k) { return sparse::multiply_add(a[k], b[k], c[k]); });
}
inline FourLanes absolute(const FourLanes& a) {
  return by_lane([&](int k) { return sparse::absolute(a[k]); });
}

}  // namespace manycontact::test
