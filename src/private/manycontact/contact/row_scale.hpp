#pragma once
// What single rows of a contact are judged beside: a row with no more than rounding of that is no row.

#include "manycontact/contact/rows.hpp"

namespace manycontact {

/// The largest motion that row k of a contact is picked from. Of a point's motion as motion_scale has it, no less than
/// a hundredth of the turning times the levers it was computed with; of turning the turning alone, in radians: a lever
/// of a million metres does not make it small. After contact_rows.
template <class S>
S row_scale(const Contact& contact, const ContactData<S>& data, int k) {
  using std::abs;
  if (k < 3) {
    if (!holds_turning(contact.type)) return motion_scale(contact, data);
    Contact point;  // whose rows are the first three of these
    point.type = ContactType::k3D;
    point.B.robot = contact.B.robot;
    point.B.joint = contact.B.joint;
    return motion_scale(point, data);
  }
  S turning(0);
  for (Eigen::Index j = 0; j < data.Jl.cols(); ++j)
    for (int i = 3; i < 6; ++i) turning = larger(S(abs(data.Jl(i, j))), turning);
  return turning;
}

}  // namespace manycontact
