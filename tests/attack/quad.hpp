#pragma once
// Quadruple precision with the compiler's own type, dual numbers for first derivatives, and three-vectors of either.
// The reference shares no code with the library, so nothing of the library is used here.

#include <quadmath.h>

#include <array>
#include <cmath>

namespace manycontact::attack {

__extension__ typedef __float128 Quad;

/// v + d e with e^2 = 0.
struct Dual {
  Quad v = 0, d = 0;
  Dual() = default;
  Dual(double x) : v(x) {}
  Dual(Quad x) : v(x) {}
  Dual(Quad x, Quad dx) : v(x), d(dx) {}
};
inline Dual operator+(const Dual& a, const Dual& b) { return {a.v + b.v, a.d + b.d}; }
inline Dual operator-(const Dual& a, const Dual& b) { return {a.v - b.v, a.d - b.d}; }
inline Dual operator-(const Dual& a) { return {-a.v, -a.d}; }
inline Dual operator*(const Dual& a, const Dual& b) { return {a.v * b.v, a.v * b.d + a.d * b.v}; }
inline Dual operator/(const Dual& a, const Dual& b) {
  const Quad q = a.v / b.v;
  return {q, (a.d - q * b.d) / b.v};
}

inline Quad value(Quad x) { return x; }
inline Quad value(const Dual& x) { return x.v; }
inline Quad slope(const Dual& x) { return x.d; }
inline Quad sine(Quad x) { return sinq(x); }
inline Quad cosine(Quad x) { return cosq(x); }
inline Quad root(Quad x) { return sqrtq(x); }
inline Quad angle(Quad y, Quad x) { return atan2q(y, x); }
inline Dual sine(const Dual& x) { return {sinq(x.v), cosq(x.v) * x.d}; }
inline Dual cosine(const Dual& x) { return {cosq(x.v), -sinq(x.v) * x.d}; }
inline Dual root(const Dual& x) {
  const Quad s = sqrtq(x.v);
  return {s, s == 0 ? Quad(0) : x.d / (2 * s)};
}
inline Dual angle(const Dual& y, const Dual& x) {
  return {atan2q(y.v, x.v), (x.v * y.d - y.v * x.d) / (x.v * x.v + y.v * y.v)};
}

template <class T>
struct Vec {
  T x[3] = {T(0.0), T(0.0), T(0.0)};
  Vec() = default;
  Vec(T a, T b, T c) : x{a, b, c} {}
  explicit Vec(const std::array<double, 3>& a) : x{T(a[0]), T(a[1]), T(a[2])} {}
  T& operator[](int i) { return x[i]; }
  const T& operator[](int i) const { return x[i]; }
};
template <class T>
Vec<T> operator+(const Vec<T>& a, const Vec<T>& b) {
  return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}
template <class T>
Vec<T> operator-(const Vec<T>& a, const Vec<T>& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
template <class T>
Vec<T> operator*(const T& s, const Vec<T>& a) {
  return {s * a[0], s * a[1], s * a[2]};
}
template <class T>
T dot(const Vec<T>& a, const Vec<T>& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
template <class T>
Vec<T> cross(const Vec<T>& a, const Vec<T>& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
template <class T>
Vec<T> unit(const Vec<T>& a) {
  return (T(1.0) / root(dot(a, a))) * a;
}

template <class T>
struct Rot {  // 3 x 3, by columns
  Vec<T> c[3] = {{T(1.0), T(0.0), T(0.0)}, {T(0.0), T(1.0), T(0.0)}, {T(0.0), T(0.0), T(1.0)}};
  const T& operator()(int i, int j) const { return c[j][i]; }
};
template <class T>
Vec<T> operator*(const Rot<T>& R, const Vec<T>& a) {
  return a[0] * R.c[0] + a[1] * R.c[1] + a[2] * R.c[2];
}
/// Returns R^T a.
template <class T>
Vec<T> back(const Rot<T>& R, const Vec<T>& a) {
  return {dot(R.c[0], a), dot(R.c[1], a), dot(R.c[2], a)};
}
template <class T>
Rot<T> operator*(const Rot<T>& A, const Rot<T>& B) {
  Rot<T> R;
  for (int j = 0; j < 3; ++j) R.c[j] = A * B.c[j];
  return R;
}

/// Rotation by an angle about a unit axis (Rodrigues).
template <class T>
Rot<T> turn(const Vec<T>& axis, const T& by) {
  const T s = sine(by), c = cosine(by);
  Rot<T> R;
  for (int j = 0; j < 3; ++j) {
    Vec<T> e;
    e[j] = T(1.0);
    R.c[j] = c * e + s * cross(axis, e) + ((T(1.0) - c) * axis[j]) * axis;
  }
  return R;
}
/// Rotation of URDF: about the fixed x, then y, then z.
template <class T>
Rot<T> turn_rpy(const std::array<double, 3>& rpy) {
  const T o(0.0), l(1.0);
  return turn(Vec<T>(o, o, l), T(rpy[2])) * turn(Vec<T>(o, l, o), T(rpy[1])) * turn(Vec<T>(l, o, o), T(rpy[0]));
}
/// Rotation of a quaternion of any length.
template <class T>
Rot<T> turn_quaternion(const T* q) {
  const T x = q[0], y = q[1], z = q[2], w = q[3], s = T(2.0) / (x * x + y * y + z * z + w * w);
  Rot<T> R;
  R.c[0] = {T(1.0) - s * (y * y + z * z), s * (x * y + z * w), s * (x * z - y * w)};
  R.c[1] = {s * (x * y - z * w), T(1.0) - s * (x * x + z * z), s * (y * z + x * w)};
  R.c[2] = {s * (x * z + y * w), s * (y * z - x * w), T(1.0) - s * (x * x + y * y)};
  return R;
}

}  // namespace manycontact::attack
