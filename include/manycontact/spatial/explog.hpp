#pragma once
// Exponential and logarithm of SO(3), SE(3) and SE(2), accurate for rotation angles near 0 and near pi, and right
// Jacobians of log6 and exp6. The logarithm is defined for angles up to pi; at pi the sign of the rotation axis is
// arbitrary. Jlog6 is a polynomial of ad that interpolates z/2 + z/2 coth(z/2) at the eigenvalues of ad: 0 and +-i t
// for a rotation angle t, each of multiplicity two. Source: Chirikjian, Stochastic Models, Information Theory, and Lie
// Groups 2 (2012), chapter 10.

#include <cmath>

#include "manycontact/spatial/se3.hpp"

namespace manycontact {

namespace detail {

/// The coefficients a = sin(t)/t, b = (1 - cos t)/t^2, c = (t - sin t)/t^3 as functions of t^2. For small t they are
/// computed by series, because the differences would cancel.
template <class S>
struct ExpCoefficients {
  S a, b, c;
  explicit ExpCoefficients(const S& t2) {
    using std::cos;
    using std::sin;
    using std::sqrt;
    if (t2 < S(0.25)) {
      // a, b, c are sums of (-1)^k t^2k / (2k+1+m)! with m = 0, 1, 2; k <= 20 gives quadruple precision for t < 1/2
      a = b = c = S(0);
      for (int k = 20; k >= 0; --k) {
        a = S(1) - a * t2 / S((2 * k + 2) * (2 * k + 3));
        b = S(1) - b * t2 / S((2 * k + 3) * (2 * k + 4));
        c = S(1) - c * t2 / S((2 * k + 4) * (2 * k + 5));
      }
      b /= S(2);
      c /= S(6);
    } else {
      const S t = sqrt(t2);
      a = sin(t) / t;
      b = (S(1) - cos(t)) / t2;
      c = (S(1) - a) / t2;
    }
  }
};

/// The coefficient alpha = (1 - k)/t^2 with k = (t/2) cot(t/2), and dalpha = d alpha / d(t^2), as functions of t^2. For
/// a position p and a rotation vector w, |w| = t, the linear part of log6 is (I - [w]x/2 + alpha [w]x^2) p.
template <class S>
struct LogCoefficients {
  S alpha, dalpha;
  explicit LogCoefficients(const S& t2) {
    using std::sin;
    using std::sqrt;
    using std::tan;
    if (t2 < S(0.25)) {
      // alpha = n/d with n = sum (-1)^k (2k+2) t^2k / (2k+4)!, d = 2 (1 - cos t)/t^2 = sum (-1)^k 2 t^2k / (2k+2)!
      S n(0), dn(0), d(0), dd(0);
      for (int k = 15; k >= 0; --k) {
        const S rn = S(-(2 * k + 4)) / S((2 * k + 2) * (2 * k + 5) * (2 * k + 6));  // ratio of term k to term k + 1
        const S rd = S(-1) / S((2 * k + 3) * (2 * k + 4));
        dn = rn * (n + t2 * dn), n = S(1) + rn * t2 * n;
        dd = rd * (d + t2 * dd), d = S(1) + rd * t2 * d;
      }
      alpha = n / (S(12) * d);
      dalpha = (dn / S(12) - alpha * dd) / d;
    } else {
      const S t = sqrt(t2), h = t / S(2);
      const S dk = S(0.5) / tan(h) - t / (S(4) * sin(h) * sin(h));  // dk/dt
      alpha = (S(1) - h / tan(h)) / t2;
      dalpha = -(alpha + dk / (S(2) * t)) / t2;
    }
  }
};

}  // namespace detail

template <class S>
/// Returns the rotation matrix of a rotation vector w [rad].
Mat3<S> exp3(const Vec3<S>& w) {
  const detail::ExpCoefficients<S> k(w.squaredNorm());
  const Mat3<S> W = skew<S>(w);
  return Mat3<S>::Identity() + k.a * W + k.b * (W * W);
}

/// Returns the rotation vector [rad] of a unit quaternion (x, y, z, w) with w >= 0: 2 atan2(|xyz|, w) xyz/|xyz|.
template <class S>
Vec3<S> log_quaternion(const Eigen::Matrix<S, 4, 1>& q) {
  using std::atan2;
  using std::sqrt;
  const Vec3<S> u = q.template head<3>();
  const S n2 = u.squaredNorm();
  if (n2 < S(1e-16)) {
    // 2 asin(n)/n = 2 (1 + n^2/6 + 3 n^4/40 + ...)
    return S(2) * (S(1) + n2 * (S(1) / S(6) + n2 * S(3) / S(40))) * u;
  }
  const S n = sqrt(n2);
  return (S(2) * atan2(n, q[3]) / n) * u;
}

template <class S>
/// Returns the rotation vector of a rotation matrix R, with |log3(R)| <= pi [rad].
Vec3<S> log3(const Mat3<S>& R) {
  return log_quaternion<S>(quaternion_of_rotation<S>(R));
}

/// Returns the exponential of a motion m = [v; w]: the placement in SE(3) that the constant velocity m, in axes of the
/// moving frame, reaches in unit time.
template <class S>
SE3<S> exp6(const Vec6<S>& m) {
  const Vec3<S> v = m.template head<3>(), w = m.template tail<3>();
  const detail::ExpCoefficients<S> k(w.squaredNorm());
  const Mat3<S> W = skew<S>(w);
  return {Mat3<S>(Mat3<S>::Identity() + k.a * W + k.b * (W * W)),
          Vec3<S>(v + k.b * w.cross(v) + k.c * w.cross(w.cross(v)))};
}

/// Returns the logarithm of a placement M: the motion m with exp6(m) = M and |angular part| <= pi.
template <class S>
Vec6<S> log6(const SE3<S>& M) {
  const Vec3<S> w = log3<S>(M.R);
  const S alpha = detail::LogCoefficients<S>(w.squaredNorm()).alpha;
  Vec6<S> m;
  const Vec3<S> wp = w.cross(M.p);
  m.template head<3>() = M.p - wp / S(2) + alpha * w.cross(wp);
  m.template tail<3>() = w;
  return m;
}

/// Returns the right Jacobian of log6: log6(M exp6(d)) = log6(M) + Jlog6(xi) d + O(d^2), with xi = log6(M).
///
///     I + ad/2 + (alpha - t^2 alpha') ad^2 - alpha' ad^4    with ad = ad_xi, alpha' = d alpha / d(t^2)
template <class S>
Mat6<S> Jlog6(const Vec6<S>& xi) {
  const S t2 = xi.template tail<3>().squaredNorm();
  const detail::LogCoefficients<S> k(t2);
  const Mat6<S> ad = cross_matrix<S>(xi);
  const Mat6<S> ad2 = ad * ad;
  return Mat6<S>::Identity() + ad / S(2) + (k.alpha - t2 * k.dalpha) * ad2 - k.dalpha * (ad2 * ad2);
}

/// Returns the right Jacobian of log6 at a placement M: log6(M exp6(d)) = log6(M) + log6_derivative(M) d + O(d^2).
template <class S>
Mat6<S> log6_derivative(const SE3<S>& M) {
  return Jlog6<S>(log6<S>(M));
}

/// Returns the right Jacobian of exp6: exp6(m + d) = exp6(m) exp6(Jexp6(m) d + O(d^2)). It is the inverse of Jlog6.
template <class S>
Mat6<S> Jexp6(const Vec6<S>& m) {
  // J = (1 - e^-ad)/ad by Horner's rule on its series after halving m; then J(2m) = 1/2 (I + Ad(exp(-m))) J(m)
  using std::ceil;
  int halvings = 0;
  S scale(1);
  while (scale * m.cwiseAbs().maxCoeff() > S(0.5) && halvings < 60) scale /= S(2), ++halvings;
  Vec6<S> x = scale * m;
  const Mat6<S> ad = cross_matrix<S>(x);
  Mat6<S> J = Mat6<S>::Identity();
  for (int k = 30; k >= 2; --k) J = Mat6<S>::Identity() - (ad * J) / S(k);
  for (int k = 0; k < halvings; ++k) {
    J = S(0.5) * (J + exp6<S>(-x).action() * J);
    x *= S(2);
  }
  return J;
}

/// Returns the exponential of m = (vx, vy, w) in SE(2): the translation in the axes at the start, and the rotation
/// angle w.
template <class S>
Vec3<S> exp_se2(const Vec3<S>& m) {
  const detail::ExpCoefficients<S> k(m[2] * m[2]);
  const S s = k.a, c = k.b * m[2];  // sin(w)/w, (1 - cos w)/w
  return Vec3<S>(s * m[0] - c * m[1], c * m[0] + s * m[1], m[2]);
}

/// Returns the logarithm in SE(2), the inverse of exp_se2, for |angle| < 2 pi.
template <class S>
Vec3<S> log_se2(const Vec3<S>& d) {
  const S w = d[2], half = w / S(2);
  const S k = S(1) - detail::LogCoefficients<S>(w * w).alpha * w * w;  // (w/2) cot(w/2)
  return Vec3<S>(k * d[0] + half * d[1], -half * d[0] + k * d[1], w);
}

}  // namespace manycontact
