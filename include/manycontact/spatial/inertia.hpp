#pragma once
// Spatial inertia as ten numbers, about the origin of its frame: mass m, first moment h = m c (c: centre of mass), and
// rotational inertia I about the origin. In this form inertias in one frame add, as CRBA and merged links need.

#include "manycontact/spatial/se3.hpp"

namespace manycontact {

template <class S>
struct Inertia {  // A rigid body's inertia.
  S m = S(0);
  Vec3<S> h = Vec3<S>::Zero();  // first moment, kg m
  Mat3<S> I = Mat3<S>::Zero();  // kg m^2, about the frame's origin, symmetric

  /// Computes the inertia from mass [kg], centre of mass [m] and rotational inertia about the centre of mass [kg m^2].
  static Inertia from_com(const S& mass, const Vec3<S>& c, const Mat3<S>& Ic) {
    return {mass, mass * c, Ic + mass * (c.squaredNorm() * Mat3<S>::Identity() - c * c.transpose())};
  }
  /// Adds the inertia of another body in the same frame.
  Inertia& operator+=(const Inertia& o) {
    m += o.m;
    h += o.h;
    I += o.I;
    return *this;
  }
  /// Returns Y a with Y = matrix(): the force that an acceleration a requires, or the momentum at a velocity a.
  template <class D>
  [[gnu::always_inline]] Vec6<S> operator*(const Eigen::MatrixBase<D>& a) const {
    const Vec3<S> v = a.template head<3>(), w = a.template tail<3>();
    Vec6<S> f;
    f.template head<3>() = add_cross(m * v, w, h);
    f.template tail<3>() = add_cross(times<S>(I, w), h, v);
    return f;
  }
  /// Returns the inertia as a 6 x 6 matrix, linear part first.
  Mat6<S> matrix() const {
    Mat6<S> Y;
    const Mat3<S> H = skew<S>(h);
    Y << m * Mat3<S>::Identity(), -H, H, I;
    return Y;
  }
  /// Returns the inertia in other axes, about the same origin. R maps coordinates from the current to the other axes.
  Inertia turned(const Mat3<S>& R) const { return {m, times<S>(R, h), congruent<S>(R, I)}; }
  /// Returns the inertia about another point, seen from which the current origin is at p. m may be 0, because the
  /// centre of mass is not computed.
  Inertia seen_at(const Vec3<S>& p) const {
    Inertia out = *this;
    out.h = add_scaled(h, m, p);
    // I - ([p][h] + [h][p]) - m [p]^2,  [a][b] = b a^T - (a.b) 1
    const Vec3<S>& t = out.h;  // h + m p
    const S d = dot(p, h) + dot(p, t);
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j <= i; ++j) {
        out.I(i, j) = multiply_add(S(-p[i]), h[j], multiply_add(S(-t[i]), p[j], out.I(i, j)));
        out.I(j, i) = out.I(i, j);
      }
      out.I(i, i) += d;
    }
    return out;
  }
  /// Returns this inertia, which is given in frame b, in frame a. aMb: placement of b in a.
  Inertia transformed(const SE3<S>& aMb) const { return turned(aMb.R).seen_at(aMb.p); }
  template <class T>
  /// Converts the scalar type.
  Inertia<T> cast() const {
    return {T(m), h.template cast<T>(), I.template cast<T>()};
  }
};

}  // namespace manycontact
