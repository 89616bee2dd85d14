#pragma once
#include "manycontact/model/scene.hpp"

namespace manycontact {

/// Returns the outward unit normal in the world of the surface on which A presses: Contact::normal or, without it, A's
/// z axis for contacts with angular rows, the world's z axis for points. oRA, oRB: axes of A, B'.
inline Vec3<double> contact_normal(const Contact& contact, const Mat3<double>& oRA, const Mat3<double>& oRB) {
  if (contact.normal) {
    const Vec3<double> n = contact.normal->normalized();  // the length may differ from 1 after add_contact
    return contact.B.robot < 0 ? n : Vec3<double>(oRB * n);
  }
  return holds_turning(contact.type) ? Vec3<double>(oRA.col(2)) : Vec3<double>(Vec3<double>::UnitZ());
}

/// Returns the linear force of a contact from the forces f of its rows, in the axes of its reference frame.
inline Vec3<double> linear_force(const Contact& contact, const double* f) {
  if (contact.type == ContactType::k1D) return f[0] * contact.axis;
  if (contact.type == ContactType::k2D) return {f[0], 0, f[1]};
  return {f[0], f[1], f[2]};
}

}  // namespace manycontact
