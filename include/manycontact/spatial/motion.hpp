#pragma once
// Spatial motions and forces as 6-vectors, linear part first: m = [v; w], f = [force; moment].
// Source: Featherstone, Rigid Body Dynamics Algorithms (2008), ch. 2, with Pinocchio's order of the parts.

#include "manycontact/spatial/scalar.hpp"

namespace manycontact {

/// [w]x, the matrix with [w]x u = w x u.
template <class S>
Mat3<S> skew(const Vec3<S>& w) {
  Mat3<S> m;
  m << S(0), -w.z(), w.y(), w.z(), S(0), -w.x(), -w.y(), w.x(), S(0);
  return m;
}

/// m1 x m2: rate of change of the motion m2 carried along by m1.
template <class A, class B>
Vec6<typename A::Scalar> cross_motion(const Eigen::MatrixBase<A>& m1, const Eigen::MatrixBase<B>& m2) {
  using S = typename A::Scalar;
  const S a = m1[0], b = m1[1], c = m1[2], p = m1[3], q = m1[4], r = m1[5];
  const S v0 = m2[0], v1 = m2[1], v2 = m2[2], w0 = m2[3], w1 = m2[4], w2 = m2[5];
  Vec6<S> out;
  out[0] = q * v2 - r * v1 + b * w2 - c * w1;
  out[1] = r * v0 - p * v2 + c * w0 - a * w2;
  out[2] = p * v1 - q * v0 + a * w1 - b * w0;
  out[3] = q * w2 - r * w1;
  out[4] = r * w0 - p * w2;
  out[5] = p * w1 - q * w0;
  return out;
}

/// m x* f: rate of change of the force f carried along by m.
template <class A, class B>
Vec6<typename A::Scalar> cross_force(const Eigen::MatrixBase<A>& m, const Eigen::MatrixBase<B>& f) {
  using S = typename A::Scalar;
  const S a = m[0], b = m[1], c = m[2], p = m[3], q = m[4], r = m[5];
  const S f0 = f[0], f1 = f[1], f2 = f[2], n0 = f[3], n1 = f[4], n2 = f[5];
  Vec6<S> out;
  out[0] = q * f2 - r * f1;
  out[1] = r * f0 - p * f2;
  out[2] = p * f1 - q * f0;
  out[3] = q * n2 - r * n1 + b * f2 - c * f1;
  out[4] = r * n0 - p * n2 + c * f0 - a * f2;
  out[5] = p * n1 - q * n0 + a * f1 - b * f0;
  return out;
}

/// ad_m, the matrix with ad_m m2 = m x m2.
template <class S>
Mat6<S> cross_matrix(const Vec6<S>& m) {
  Mat6<S> ad;
  const Mat3<S> w = skew<S>(m.template tail<3>());
  ad << w, skew<S>(m.template head<3>()), Mat3<S>::Zero(), w;
  return ad;
}

}  // namespace manycontact
