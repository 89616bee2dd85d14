#pragma once
// Errors against a truth are in the maximum norm. They are NaN if either contains NaN, so that EXPECT_LE fails.

#include <limits>

#include "manycontact/spatial/se3.hpp"

namespace manycontact::test {

inline constexpr double kEps = std::numeric_limits<double>::epsilon();

/// Returns the largest magnitude of an entry; NaN if one is NaN.
template <class D>
double size_of(const Eigen::DenseBase<D>& x) {
  double largest = 0;
  for (Eigen::Index j = 0; j < x.cols(); ++j)
    for (Eigen::Index i = 0; i < x.rows(); ++i) {
      const double magnitude = std::abs(static_cast<double>(x(i, j)));
      if (!(magnitude <= largest)) largest = magnitude;
      if (largest != largest) return largest;
    }
  return largest;
}

/// Returns max |x - truth|, subtracted in the truth's precision.
template <class A, class B>
double difference_of(const Eigen::MatrixBase<A>& x, const Eigen::MatrixBase<B>& truth) {
  if (x.rows() != truth.rows() || x.cols() != truth.cols()) return std::numeric_limits<double>::quiet_NaN();
  return size_of((x.template cast<typename B::Scalar>() - truth).eval());
}

/// Returns max |x - truth| / max |truth|; 0 if both are zero.
template <class A, class B>
double error_of(const Eigen::MatrixBase<A>& x, const Eigen::MatrixBase<B>& truth) {
  const double difference = difference_of(x, truth);
  return difference == 0 ? 0 : difference / size_of(truth);
}

/// Compares placements entry by entry, and returns the larger of both parts' differences.
template <class A, class B>
double difference_of(const SE3<A>& x, const SE3<B>& truth) {
  const double R = difference_of(x.R, truth.R), p = difference_of(x.p, truth.p);
  return R >= p ? R : p >= R ? p : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace manycontact::test
