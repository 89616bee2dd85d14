#pragma once
// Small products as chains of multiply_add. Products and sums are fused explicitly, since the compiler would fuse them
// differently for each pack width. The functions are always inlined, as calls would pass packs through memory.

#include "manycontact/spatial/scalar.hpp"

namespace manycontact {

/// Returns x^T y.
template <class X, class Y>
[[gnu::always_inline]] inline typename X::Scalar dot(const Eigen::MatrixBase<X>& x, const Eigen::MatrixBase<Y>& y) {
  typename X::Scalar s = x[0] * y[0];
  for (Eigen::Index i = 1; i < x.size(); ++i) s = multiply_add(x[i], y[i], s);
  return s;
}

/// Returns c + x^T y.
template <class S, class X, class Y>
[[gnu::always_inline]] inline S add_dot(S c, const Eigen::MatrixBase<X>& x, const Eigen::MatrixBase<Y>& y) {
  for (Eigen::Index i = 0; i < x.size(); ++i) c = multiply_add(x[i], y[i], c);
  return c;
}

/// Returns the cross product x x y.
template <class X, class Y>
[[gnu::always_inline]] inline Vec3<typename X::Scalar> cross(const Eigen::MatrixBase<X>& x,
                                                             const Eigen::MatrixBase<Y>& y) {
  using S = typename X::Scalar;
  const S x0 = x[0], x1 = x[1], x2 = x[2], y0 = y[0], y1 = y[1], y2 = y[2];
  return {multiply_add(x1, y2, S(-(x2 * y1))), multiply_add(x2, y0, S(-(x0 * y2))),
          multiply_add(x0, y1, S(-(x1 * y0)))};
}

/// Returns c + x x y.
template <class C, class X, class Y>
[[gnu::always_inline]] inline Vec3<typename C::Scalar> add_cross(const Eigen::MatrixBase<C>& c,
                                                                 const Eigen::MatrixBase<X>& x,
                                                                 const Eigen::MatrixBase<Y>& y) {
  using S = typename C::Scalar;
  const S x0 = x[0], x1 = x[1], x2 = x[2], y0 = y[0], y1 = y[1], y2 = y[2];
  return {multiply_add(x1, y2, multiply_add(S(-x2), y1, S(c[0]))),
          multiply_add(x2, y0, multiply_add(S(-x0), y2, S(c[1]))),
          multiply_add(x0, y1, multiply_add(S(-x1), y0, S(c[2])))};
}

/// Returns c + s x.
template <class C, class S, class X>
[[gnu::always_inline]] inline Vec3<S> add_scaled(const Eigen::MatrixBase<C>& c, const S& s,
                                                 const Eigen::MatrixBase<X>& x) {
  return {multiply_add(s, S(x[0]), S(c[0])), multiply_add(s, S(x[1]), S(c[1])), multiply_add(s, S(x[2]), S(c[2]))};
}

/// Returns A x.
template <class S, class X>
[[gnu::always_inline]] inline Vec3<S> times(const Mat3<S>& A, const Eigen::MatrixBase<X>& x) {
  const S x0 = x[0], x1 = x[1], x2 = x[2];
  Vec3<S> out;
  for (int i = 0; i < 3; ++i) out[i] = multiply_add(A(i, 2), x2, multiply_add(A(i, 1), x1, S(A(i, 0) * x0)));
  return out;
}

/// Returns c + A x.
template <class S, class X>
[[gnu::always_inline]] inline Vec3<S> add_times(const Vec3<S>& c, const Mat3<S>& A, const Eigen::MatrixBase<X>& x) {
  const S x0 = x[0], x1 = x[1], x2 = x[2];
  Vec3<S> out;
  for (int i = 0; i < 3; ++i)
    out[i] = multiply_add(A(i, 2), x2, multiply_add(A(i, 1), x1, multiply_add(A(i, 0), x0, c[i])));
  return out;
}

/// Returns A^T x.
template <class S, class X>
[[gnu::always_inline]] inline Vec3<S> transpose_times(const Mat3<S>& A, const Eigen::MatrixBase<X>& x) {
  const S x0 = x[0], x1 = x[1], x2 = x[2];
  Vec3<S> out;
  for (int i = 0; i < 3; ++i) out[i] = multiply_add(A(2, i), x2, multiply_add(A(1, i), x1, S(A(0, i) * x0)));
  return out;
}

/// Returns A B.
template <class S>
[[gnu::always_inline]] inline Mat3<S> times(const Mat3<S>& A, const Mat3<S>& B) {
  Mat3<S> out;
  for (int j = 0; j < 3; ++j) out.col(j) = times<S>(A, B.col(j));
  return out;
}

/// Returns A^T B.
template <class S>
[[gnu::always_inline]] inline Mat3<S> transpose_times(const Mat3<S>& A, const Mat3<S>& B) {
  Mat3<S> out;
  for (int j = 0; j < 3; ++j) out.col(j) = transpose_times<S>(A, B.col(j));
  return out;
}

/// Returns R I R^T for a symmetric I; the result is exactly symmetric.
template <class S>
[[gnu::always_inline]] inline Mat3<S> congruent(const Mat3<S>& R, const Mat3<S>& I) {
  const Mat3<S> RI = times<S>(R, I);
  Mat3<S> out;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j <= i; ++j)
      out(i, j) = out(j, i) = multiply_add(RI(i, 2), R(j, 2), multiply_add(RI(i, 1), R(j, 1), S(RI(i, 0) * R(j, 0))));
  return out;
}

}  // namespace manycontact
