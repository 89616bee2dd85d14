#pragma once
// Motions of joints, and placements of the bodies from a tree's root to its anchor (detail/algorithm/kinematics.hpp).

#include <cstdint>
#include <limits>

#include "manycontact/algorithm/model_numbers.hpp"

namespace manycontact {

/// Sets R to R Rot(e_k, angle), which combines two columns of R. c, s: cosine and sine of the angle.
template <class S>
inline void rotate_columns(Mat3<S>& R, int k, const S& c, const S& s) {
  const int i = k == 2 ? 0 : k + 1, j = k == 0 ? 2 : k - 1;
  for (int row = 0; row < 3; ++row) {
    const S x = R(row, i), y = R(row, j);
    R(row, i) = multiply_add(s, y, S(c * x));
    R(row, j) = multiply_add(S(-s), x, S(c * y));
  }
}

/// Returns the axis of a revolute or prismatic joint from the axes R of its joint frame or, equally, its child frame.
template <class S>
inline Vec3<S> axis_of(const Joint& joint, const Mat3<S>& R) {
  if (joint.axis_kind < 3) return R.col(joint.axis_kind);
  return times<S>(R, joint.axis.cast<S>());
}

/// Returns the angle whose sine and cosine move_frame needs, or zero for a joint without an angle.
template <class S>
inline S angle_of(const Joint& joint, const ConstVecRef<S>& q) {
  if (joint.type == JointType::kRevolute) return q[joint.idx_q];
  return joint.type == JointType::kPlanar ? q[joint.idx_q + 2] : S(0);
}

/// Moves the joint frame's rotation R and origin p to the child frame at q. s, c: sine, cosine of the joint's angle.
template <class S>
[[gnu::always_inline]] inline void move_frame(const Joint& joint, const ConstVecRef<S>& q, const S& s, const S& c,
                                              Mat3<S>& R, Vec3<S>& p) {
  const int iq = joint.idx_q;
  switch (joint.type) {
    case JointType::kRevolute:
      if (joint.axis_kind < 3)
        rotate_columns<S>(R, joint.axis_kind, c, s);
      else
        R = times<S>(R, rotation_about<S>(joint.axis.cast<S>(), s, c));
      break;
    case JointType::kPrismatic:
      p += q[iq] * axis_of<S>(joint, R);
      break;
    case JointType::kFloating:
      p += R * q.template segment<3>(iq);
      R = times<S>(R, rotation_of_quaternion<S>(q[iq + 3], q[iq + 4], q[iq + 5], q[iq + 6]));
      break;
    case JointType::kPlanar:
      p += R.col(0) * q[iq] + R.col(1) * q[iq + 1];
      rotate_columns<S>(R, 2, c, s);
      break;
  }
}

namespace detail {

/// Returns the upper half of the digits of a. Source: Veltkamp, as in Dekker, Numerische Mathematik 18 (1971).
template <class S>
inline S upper_half(const S& a) {
  int digits = std::numeric_limits<S>::digits;
  if constexpr (requires { typename S::Element; }) digits = std::numeric_limits<typename S::Element>::digits;
  const S c = a * (S(static_cast<double>(std::int64_t(1) << ((digits + 1) / 2))) + S(1));
  return c - (c - a);
}

/// Adds a b to `sum` + `rest` without rounding the product. Source: Dekker's product and Knuth's sum.
template <class S>
inline void add_exactly(const S& a, const S& b, S& sum, S& rest) {
  const S ah = upper_half(a), al = a - ah, bh = upper_half(b), bl = b - bh;
  const S ab = a * b, of_product = al * bl - (((ab - ah * bh) - al * bh) - ah * bl);
  const S total = sum + ab, other = total - sum;
  rest += of_product + ((sum - (total - other)) + (ab - other));
  sum = total;
}

/// Adds x times the axis to the point, without rounding the products.
template <class S>
inline void move_along(const Vec3<S>& axis, const S& x, WorldPoint<S>& point) {
  for (int k = 0; k < 3; ++k) add_exactly<S>(axis[k], x, point.p[k], point.rest[k]);
}

/// Adds the displacement of a joint at q to a point. R: axes of the joint frame.
template <class S>
inline void displace(const Joint& joint, const ConstVecRef<S>& q, const Mat3<S>& R, WorldPoint<S>& point) {
  if (joint.type == JointType::kPrismatic) move_along<S>(axis_of<S>(joint, R), q[joint.idx_q], point);
  const int n = joint.type == JointType::kFloating ? 3 : joint.type == JointType::kPlanar ? 2 : 0;
  for (int k = 0; k < n; ++k) move_along<S>(R.col(k), q[joint.idx_q + k], point);
}

}  // namespace detail

/// Computes the placement of each body on a tree's path relative to the tree's anchor, and returns the anchor's
/// position in the world. place(joint) must return a reference to the placement. s, c: sine and cosine of the root
/// joint's angle. own: the robot's own parameters, or nullptr for the model's. base: world placement of a fixed base.
template <class S, class B, class Place>
WorldPoint<S> place_path(const Model& model, const ModelNumbers<S>* own, const Tree& tree, const SE3<B>& base,
                         const ConstVecRef<S>& q, const S& s, const S& c, Place&& place) {
  WorldPoint<S> anchor;
  if (model.floating_base) {
    SE3<S>& M = place(tree.root);
    M.R = rotation_of_quaternion<S>(q[3], q[4], q[5], q[6]);
    M.p.setZero();
    anchor.p = q.template head<3>();
    return anchor;
  }
  anchor.p = base.p.template cast<S>();
  Mat3<S> R = base.R.template cast<S>();
  for (int i : tree.path) {  // M.p: at first relative to the parent's origin
    const Joint& joint = model.joints[i];
    SE3<S>& M = place(i);
    const PlacementOf<S> placement(model, own, i);
    const Vec3<S> p = placement.p();
    M.p = times<S>(R, p);
    for (int k = 0; k < 3; ++k) detail::move_along<S>(R.col(k), p[k], anchor);
    M.R = joint.placement_rotates ? times<S>(R, placement.R()) : R;
    detail::displace<S>(joint, q, M.R, anchor);
    S sine = s, cosine = c;
    if (i != tree.root) sin_cos(angle_of<S>(joint, q), sine, cosine);
    move_frame<S>(joint, q, sine, cosine, M.R, M.p);
    R = M.R;
  }
  Vec3<S> p = Vec3<S>::Zero();
  for (std::size_t k = tree.path.size(); k-- > 0;) {  // makes positions relative to the anchor
    Vec3<S>& at = place(tree.path[k]).p;
    const Vec3<S> step = at;
    at = p;
    p -= step;
  }
  return anchor;
}

}  // namespace manycontact
