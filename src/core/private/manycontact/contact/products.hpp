#pragma once
// Products with derivatives of one contact's rows (detail/contact/rows.hpp), in forward and reverse mode.

#include "manycontact/algorithm/rnea_products.hpp"
#include "manycontact/detail/contact/rows.hpp"

namespace manycontact {

/// Computes changes along variations a, b of the bodies of A and B (in tree frames; b is zero for the world). dr2 is
/// the change of the rows' residual r2 = W x (detail/contact/rows.hpp), which includes the rotation of W. dF is the
/// change of the force on A in A's axes, which includes the force's rotation. rows: the contact's data at the
/// accelerations of the solution. f: the contact's force.
template <class S>
void contact_tangent(const Contact& contact, const ContactData<S>& rows, const BodyVariationOf<S>& a,
                     const BodyVariationOf<S>& b, const ConstVecRef<S>& f, VecRef<S> dr2, Vec6<S>& dF);

/// Adds the gradients of -w^T J^T f + l^T W x to the adjoints a, b of the bodies of A and B, in tree frames. W x: the
/// rows' residual. uA, uB: virtual velocities of these bodies (virtual_velocities of w). l: one entry per row.
template <class S>
void contact_adjoint(const Contact& contact, const ContactData<S>& rows, const Vec6<S>& uA, const Vec6<S>& uB,
                     const ConstVecRef<S>& f, const ConstVecRef<S>& l, BodyVariationOf<S>& a, BodyVariationOf<S>& b);

/// Calls add(attachment, force in its tree frame) for A and B if they move. F acts on A, in A's axes; -F on B'.
template <class S, class Add>
void each_body_force(const Contact& contact, const ContactData<S>& rows, const Vec6<S>& F, Add&& add) {
  if (moves(contact.A)) add(contact.A, Vec6<S>(rows.aMA.act_force(F)));
  if (moves(contact.B)) add(contact.B, Vec6<S>(-rows.bMA.act_force(F)));
}

}  // namespace manycontact
