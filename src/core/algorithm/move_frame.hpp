#pragma once
// How a joint's motion moves its frame, whatever origin the motion subspaces are about.

#include "manycontact/model/model.hpp"

namespace manycontact {

/// R <- R Rot(e_k, angle): mixes two columns.
template <class S>
inline void rotate_columns(Mat3<S>& R, int k, const S& c, const S& s) {
  const int i = k == 2 ? 0 : k + 1, j = k == 0 ? 2 : k - 1;
  for (int row = 0; row < 3; ++row) {
    const S x = R(row, i), y = R(row, j);
    R(row, i) = multiply_add(s, y, S(c * x));
    R(row, j) = multiply_add(S(-s), x, S(c * y));
  }
}

/// A revolute or prismatic joint's axis, by the joint frame's or the child frame's R: the joint does not turn it.
template <class S>
inline Vec3<S> axis_of(const Joint& joint, const Mat3<S>& R) {
  if (joint.axis_kind < 3) return R.col(joint.axis_kind);
  return times<S>(R, joint.axis.cast<S>());
}

/// The angle that move_frame wants sine and cosine of; zero where the joint has none.
template <class S>
inline S angle_of(const Joint& joint, const ConstVecRef<S>& q) {
  if (joint.type == JointType::kRevolute) return q[joint.idx_q];
  return joint.type == JointType::kPlanar ? q[joint.idx_q + 2] : S(0);
}

/// Moves R, p from the joint frame to the child frame. s, c: sine and cosine of the joint's angle.
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

}  // namespace manycontact
