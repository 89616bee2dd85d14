#pragma once
// What a contact's a0 is computed from: the scale by which its rounding is judged. Per lane, where robots stand side by
// side.

#include "manycontact/contact/rows.hpp"
#include "manycontact/kkt/island.hpp"

namespace manycontact::internal {

/// The largest entry.
template <class S, class X>
S largest_entry(const X& x) {
  using std::abs;
  S largest(0);
  for (Eigen::Index j = 0; j < x.cols(); ++j)
    for (Eigen::Index i = 0; i < x.rows(); ++i) largest = larger(S(abs(x(i, j))), largest);
  return largest;
}

/// How far a tree frame's origin is off, in units of rounding: none where the axes that joints displace it along are as
/// given, for its sum is exact then.
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

/// The sizes of all terms that a contact's a0 is computed from [m/s^2, rad/s^2]: accelerations (gravity in them),
/// products of velocities, and what gains answer. Their error is a difference of placements, as good as these are.
/// origin: how far the bodies' origins are off, in units of rounding.
template <class S>
S row_terms(const Contact& contact, const ContactData<S>& data, const S& origin) {
  const auto largest = [](const auto& x) { return largest_entry<S>(x); };
  const S v = larger(largest(data.vA), largest(data.vB));
  return largest(data.aA) + largest(data.aB) + v * v + S(std::abs(contact.beta)) * v +
         S(std::abs(contact.alpha)) * (S(1) + largest(data.aMA.p) + largest(data.bMA.p) + origin + largest(data.on_B));
}

/// The same where the bodies are placed from the world on. kinA, kinB: of the robots of A and B; of a B that does not
/// move unused.
template <class S>
S row_terms(const Contact& contact, const ContactData<S>& data, const Model& A, const Kinematics<S>& kinA,
            const Model& B, const Kinematics<S>& kinB) {
  S origin(0);
  if (moves(contact.A)) origin += origin_rounding<S>(A, kinA, contact.A.joint);
  if (moves(contact.B)) origin += origin_rounding<S>(B, kinB, contact.B.joint);
  return row_terms<S>(contact, data, origin);
}

/// The largest term that a contact's a0 is computed from. Of the bodies' velocities and accelerations as the tree has
/// them, about its base: at the contact they may cancel. place: B's in the world [m].
template <class S>
S contact_drift(const Contact& contact, const ContactData<S>& data, const Model& A, const Kinematics<S>& kinA,
                const Model& B, const Kinematics<S>& kinB, const Vec3<S>& place) {
  S most = row_terms<S>(contact, data, A, kinA, B, kinB);
  const auto add_body = [&](const Attachment& at, const Kinematics<S>& kin) {
    if (!moves(at)) return;
    const S v = largest_entry<S>(kin.v[at.joint]);
    most = larger(larger(largest_entry<S>(kin.a[at.joint]), S(v * v)), most);
  };
  add_body(contact.A, kinA), add_body(contact.B, kinB);
  // A place in the world that was left out, or computed, is as good as its own digits, however far away it is.
  if (contact.B.robot < 0) most = larger(S(std::abs(contact.alpha)) * largest_entry<S>(place), most);
  return most;
}

}  // namespace manycontact::internal
