#pragma once
// Spatial motions and forces as 6-vectors, linear part first: m = [v; w], f = [force; moment].
// Source: Featherstone, Rigid Body Dynamics Algorithms (2008), ch. 2, with Pinocchio's order of the parts.

#include "manycontact/detail/spatial/products.hpp"

namespace manycontact {

/// Returns the skew matrix [w]x of a vector w: [w]x u = w x u.
template <class S>
Mat3<S> skew(const Vec3<S>& w) {
  Mat3<S> m;
  m << S(0), -w.z(), w.y(), w.z(), S(0), -w.x(), -w.y(), w.x(), S(0);
  return m;
}

/// Returns m1 x m2, the rate of change of a motion m2 that is fixed to a body moving with m1.
template <class A, class B>
[[gnu::always_inline]] inline Vec6<typename A::Scalar> cross_motion(const Eigen::MatrixBase<A>& m1,
                                                                    const Eigen::MatrixBase<B>& m2) {
  using S = typename A::Scalar;
  const Vec3<S> v = m1.template head<3>(), w = m1.template tail<3>(), w2 = m2.template tail<3>();
  Vec6<S> out;
  out.template head<3>() = add_cross(cross(w, m2.template head<3>()), v, w2);
  out.template tail<3>() = cross(w, w2);
  return out;
}

/// Returns c + m1 x m2.
template <class C, class A, class B>
[[gnu::always_inline]] inline Vec6<typename A::Scalar> add_cross_motion(const Eigen::MatrixBase<C>& c,
                                                                        const Eigen::MatrixBase<A>& m1,
                                                                        const Eigen::MatrixBase<B>& m2) {
  using S = typename A::Scalar;
  const Vec3<S> v = m1.template head<3>(), w = m1.template tail<3>(), w2 = m2.template tail<3>();
  Vec6<S> out;
  out.template head<3>() = add_cross(add_cross(c.template head<3>(), w, m2.template head<3>()), v, w2);
  out.template tail<3>() = add_cross(c.template tail<3>(), w, w2);
  return out;
}

/// Returns m x* f, the rate of change of a force f that is fixed to a body moving with m.
template <class A, class B>
[[gnu::always_inline]] inline Vec6<typename A::Scalar> cross_force(const Eigen::MatrixBase<A>& m,
                                                                   const Eigen::MatrixBase<B>& f) {
  using S = typename A::Scalar;
  const Vec3<S> v = m.template head<3>(), w = m.template tail<3>(), force = f.template head<3>();
  Vec6<S> out;
  out.template head<3>() = cross(w, force);
  out.template tail<3>() = add_cross(cross(w, f.template tail<3>()), v, force);
  return out;
}

/// Returns c + m x* f.
template <class C, class A, class B>
[[gnu::always_inline]] inline Vec6<typename A::Scalar> add_cross_force(const Eigen::MatrixBase<C>& c,
                                                                       const Eigen::MatrixBase<A>& m,
                                                                       const Eigen::MatrixBase<B>& f) {
  using S = typename A::Scalar;
  const Vec3<S> v = m.template head<3>(), w = m.template tail<3>(), force = f.template head<3>();
  Vec6<S> out;
  out.template head<3>() = add_cross(c.template head<3>(), w, force);
  out.template tail<3>() = add_cross(add_cross(c.template tail<3>(), w, f.template tail<3>()), v, force);
  return out;
}

/// Returns the 6 x 6 matrix ad_m of a motion m: ad_m m2 = m x m2.
template <class S>
Mat6<S> cross_matrix(const Vec6<S>& m) {
  Mat6<S> ad;
  const Mat3<S> w = skew<S>(m.template tail<3>());
  ad << w, skew<S>(m.template head<3>()), Mat3<S>::Zero(), w;
  return ad;
}

}  // namespace manycontact
