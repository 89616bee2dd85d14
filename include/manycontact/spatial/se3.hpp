#pragma once
// Placements. aMb = (R, p) maps coordinates x_b in frame b to coordinates in frame a: x_a = R x_b + p.

#include "manycontact/spatial/motion.hpp"

namespace manycontact {

template <class S>
struct SE3 {  // A placement: origin p in the parent's axes, rotation R to the parent's axes.
  Mat3<S> R = Mat3<S>::Identity();
  Vec3<S> p = Vec3<S>::Zero();

  static SE3 Identity() { return {}; }              // R = 1, p = 0
  const Mat3<S>& rotation() const { return R; }     // Pinocchio's name of R
  const Vec3<S>& translation() const { return p; }  // Pinocchio's name of p

  /// Returns the product aMc = aMb bMc.
  SE3 operator*(const SE3& o) const { return {times<S>(R, o.R), add_times<S>(p, R, o.p)}; }
  /// Returns the inverse placement bMa.
  SE3 inverse() const { return {R.transpose(), -transpose_times<S>(R, p)}; }

  /// Transforms a motion m from coordinates of frame b to those of frame a: X m with X = action().
  template <class D>
  Vec6<S> act(const Eigen::MatrixBase<D>& m) const {
    Vec6<S> out;
    const Vec3<S> w = times<S>(R, m.template tail<3>());
    out.template head<3>() = add_cross(times<S>(R, m.template head<3>()), p, w);
    out.template tail<3>() = w;
    return out;
  }
  /// Transforms a motion m from coordinates of frame a to those of frame b: X^-1 m with X = action().
  template <class D>
  Vec6<S> act_inverse(const Eigen::MatrixBase<D>& m) const {
    Vec6<S> out;
    const Vec3<S> w = m.template tail<3>();
    const Vec3<S> v = add_cross(m.template head<3>(), w, p);
    out.template head<3>() = transpose_times<S>(R, v);
    out.template tail<3>() = transpose_times<S>(R, w);
    return out;
  }
  /// Transforms a force f from coordinates of frame b to those of frame a: X^-T f with X = action().
  template <class D>
  Vec6<S> act_force(const Eigen::MatrixBase<D>& f) const {
    Vec6<S> out;
    const Vec3<S> force = times<S>(R, f.template head<3>());
    out.template head<3>() = force;
    out.template tail<3>() = add_cross(times<S>(R, f.template tail<3>()), p, force);
    return out;
  }
  /// Returns the matrix X (6 x 6) with act(m) = X m.
  Mat6<S> action() const {
    Mat6<S> X;
    X << R, skew<S>(p) * R, Mat3<S>::Zero(), R;
    return X;
  }
  template <class T>
  SE3<T> cast() const {  // converts the scalar type
    return {R.template cast<T>(), p.template cast<T>()};
  }
};

/// Returns the rotation matrix about the unit vector `axis` by an angle with sine s and cosine c (Rodrigues' formula).
template <class S>
Mat3<S> rotation_about(const Vec3<S>& axis, const S& s, const S& c) {
  return c * Mat3<S>::Identity() + s * skew<S>(axis) + (S(1) - c) * (axis * axis.transpose());
}
/// Returns the rotation matrix about the unit vector `axis` by `angle` [rad].
template <class S>
Mat3<S> rotation_about(const Vec3<S>& axis, const S& angle) {
  S s, c;
  sin_cos(angle, s, c);
  return rotation_about<S>(axis, s, c);
}

/// Returns the rotation matrix of a quaternion (x, y, z, w). Even if the quaternion's norm is only nearly 1, the matrix
/// is orthonormal up to rounding errors.
template <class S>
Mat3<S> rotation_of_quaternion(const S& x, const S& y, const S& z, const S& w) {
  const S s = S(2) / (x * x + y * y + z * z + w * w);
  Mat3<S> R;
  R << S(1) - s * (y * y + z * z), s * (x * y - w * z), s * (x * z + w * y),  //
      s * (x * y + w * z), S(1) - s * (x * x + z * z), s * (y * z - w * x),   //
      s * (x * z - w * y), s * (y * z + w * x), S(1) - s * (x * x + y * y);
  return R;
}

/// Returns the unit quaternion (x, y, z, w), w >= 0, of a rotation matrix R by Shepperd's method, which is accurate at
/// any angle.
template <class S>
Eigen::Matrix<S, 4, 1> quaternion_of_rotation(const Mat3<S>& R) {
  using std::sqrt;
  Eigen::Matrix<S, 4, 1> q;
  const S trace = R(0, 0) + R(1, 1) + R(2, 2);
  int k = 3;
  S best = trace;
  for (int i = 0; i < 3; ++i)
    if (R(i, i) > best) best = R(i, i), k = i;
  if (k == 3) {
    q << R(2, 1) - R(1, 2), R(0, 2) - R(2, 0), R(1, 0) - R(0, 1), S(1) + trace;
  } else {
    const int i = k, j = (i + 1) % 3, l = (i + 2) % 3;
    q[i] = S(1) + R(i, i) - R(j, j) - R(l, l);
    q[j] = R(i, j) + R(j, i);
    q[l] = R(i, l) + R(l, i);
    q[3] = R(l, j) - R(j, l);
  }
  const S norm = sqrt(q.squaredNorm());
  q /= (q[3] < S(0)) ? S(-norm) : norm;
  return q;
}

/// Returns the seven coordinates x y z, qx qy qz qw of a placement, with qw >= 0.
template <class S>
Eigen::Matrix<S, 7, 1> pose_of_placement(const SE3<S>& M) {
  Eigen::Matrix<S, 7, 1> pose;
  pose << M.p, quaternion_of_rotation<S>(M.R);
  return pose;
}

/// Returns the placement with the coordinates x y z, qx qy qz qw, as the inverse of pose_of_placement.
template <class D>
SE3<typename D::Scalar> placement_of_pose(const Eigen::MatrixBase<D>& pose) {
  return {rotation_of_quaternion<typename D::Scalar>(pose[3], pose[4], pose[5], pose[6]), pose.template head<3>()};
}

}  // namespace manycontact
