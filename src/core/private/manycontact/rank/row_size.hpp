#pragma once
// The sizes relative to which contact rows and residuals are judged: the motion from which a row of J is selected, and
// the terms of its a0. In SIMD batches the scalar S has one value per robot.

#include "manycontact/detail/contact/rows.hpp"

namespace manycontact {

/// Returns the largest motion from which row k of a contact is selected: for k < 3 that of the contact's point
/// (MotionSizes::of_point), otherwise the rotation. Rows of a pair are sums of both. Call it after contact_rows.
template <class S>
S row_size(const MotionSizes<S>& of, const Contact& contact, const ContactData<S>& data, int k) {
  if (contact.pair) return data.pair->terms(k, 0) * of.of_point + data.pair->terms(k, 1) * of.turning;
  return k < 3 ? of.of_point : of.turning;
}
template <class S>
S row_size(const Contact& contact, const ContactData<S>& data, int k) {
  return row_size<S>(motion_sizes<S>(contact, data), contact, data, k);
}

namespace internal {

template <class S, class X>
S largest_entry(const X& x) {
  using std::abs;
  S largest(0);
  for (Eigen::Index j = 0; j < x.cols(); ++j)
    for (Eigen::Index i = 0; i < x.rows(); ++i) largest = larger(S(abs(x(i, j))), largest);
  return largest;
}

/// Returns the rounding error, divided by eps, of the origin of a joint's tree frame. It is zero if joints displace the
/// origin along constant axes only.
template <class S>
S origin_rounding(const Model& model, const Kinematics<S>& kin, int joint) {
  if (model.floating_base) return S(0);
  const int tree = model.tree_of[joint];
  bool turned = false, off = false;
  for (int i : model.trees[tree].path) {
    turned = turned || model.joints[i].placement_rotates;
    off = off || turned;
    turned = turned || model.joints[i].type != JointType::kPrismatic;
  }
  return off ? largest_entry<S>(kin.origins[tree].p) : S(0);
}

/// The weights of displacements and of rotations in a row of a contact. row_weights returns those of row i.
template <class S>
struct RowWeights {
  S linear, angular;
};
template <class S>
RowWeights<S> row_weights(const PairNumbers<S>* pair, int i) {
  if (pair) return {pair->terms(i, 0), pair->terms(i, 1)};
  return {S(i < 3 ? 1 : 0), S(i < 3 ? 0 : 1)};
}
template <class S>
RowWeights<S> row_weights(const ContactData<S>& data, int i) {
  return row_weights<S>(data.pair ? &*data.pair : nullptr, i);
}

/// The largest terms of a contact's a0: `linear` [m/s^2] for rows 0 to 2, `angular` [rad/s^2] for the others. Neither
/// bounds the other if lengths are micrometres. Rows of a pair are sums of both.
template <class S>
struct RowTerms {
  S linear = S(0), angular = S(0);
  const PairNumbers<S>* pair = nullptr;  // weights of the rows of a pair; nullptr: no pair
  S of_row(int i) const {
    if (pair) return pair->terms(i, 0) * linear + pair->terms(i, 1) * angular;
    return i < 3 ? linear : angular;
  }
};

/// Returns the largest terms of a contact's a0: accelerations (including gravity), products of velocities, and gains
/// times the placements whose difference is the contact's error. origin: rounding error of the bodies' origins / eps.
template <class S>
RowTerms<S> row_terms(const Contact& contact, const ContactData<S>& data, const S& origin) {
  const auto largest = [](const auto& x) { return largest_entry<S>(x); };
  const auto of_both = [&](const Vec6<S>& A, const Vec6<S>& B, int first) {
    return larger(largest(A.template segment<3>(first)), largest(B.template segment<3>(first)));
  };
  const S v = of_both(data.vA, data.vB, 0), w = of_both(data.vA, data.vB, 3);
  const S alpha(std::abs(contact.alpha)), beta(std::abs(contact.beta));
  const auto accelerations = [&](int first) {
    return largest(data.aA.template segment<3>(first)) + largest(data.aB.template segment<3>(first));
  };
  return {accelerations(0) + w * v + beta * v +
              alpha * (largest(data.aMA.p) + largest(data.bMA.p) + origin + largest(data.on_B)),
          accelerations(3) + w * w + beta * w + alpha, data.pair ? &*data.pair : nullptr};
}

/// Returns row_terms from the models and kinematics of A's and B's robots, which are unused for an immovable frame.
template <class S>
RowTerms<S> row_terms(const Contact& contact, const ContactData<S>& data, const Model& A, const Kinematics<S>& kinA,
                      const Model& B, const Kinematics<S>& kinB) {
  S origin(0);
  if (moves(contact.A)) origin += origin_rounding<S>(A, kinA, contact.A.joint);
  if (moves(contact.B)) origin += origin_rounding<S>(B, kinB, contact.B.joint);
  return row_terms<S>(contact, data, origin);
}

/// Returns row_terms, raised to the accelerations that the bodies' motions about the tree frame's origin give at the
/// contact, where their terms may cancel. place: position of B in the world [m].
template <class S>
RowTerms<S> bias_acceleration_terms(const Contact& contact, const ContactData<S>& data, const Model& A,
                                    const Kinematics<S>& kinA, const Model& B, const Kinematics<S>& kinB,
                                    const Vec3<S>& place) {
  RowTerms<S> most = row_terms<S>(contact, data, A, kinA, B, kinB);
  const auto add_body = [&](const Attachment& at, const Kinematics<S>& kin, const Vec3<S>& p) {
    if (!moves(at)) return;
    const Vec6<S>&v = kin.v[at.joint], &a = kin.a[at.joint];
    const S lever = largest_entry<S>(p), turning = largest_entry<S>(v.template tail<3>());
    const S moved = larger(largest_entry<S>(v.template head<3>()), S(turning * lever));
    const S turned = larger(largest_entry<S>(a.template tail<3>()), S(turning * turning));
    const S largest = larger(largest_entry<S>(a.template head<3>()), S(turning * moved));
    most.angular = larger(turned, most.angular);
    most.linear = larger(larger(largest, S(turned * lever)), most.linear);
  };
  add_body(contact.A, kinA, data.aMA.p), add_body(contact.B, kinB, data.bMA.p);
  // The rounding error of a placement in the world is relative to its distance from the origin.
  if (contact.B.robot < 0) most.linear = larger(S(S(std::abs(contact.alpha)) * largest_entry<S>(place)), most.linear);
  return most;
}

}  // namespace internal

}  // namespace manycontact
