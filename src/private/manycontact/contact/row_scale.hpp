#pragma once
// What single rows of a contact are judged beside: a row with no more than rounding of that is no row.

#include "manycontact/contact/rows.hpp"

namespace manycontact {

/// The largest motion that row k of a contact is picked from. Of a point's motion as motion_scale has it, no less than
/// a hundredth of the turning times the levers it was computed with; of turning the turning alone, in radians: a lever
/// of a million metres does not make it small. After contact_rows.
template <class S>
S row_scale(const Contact& contact, const ContactData<S>& data, int k) {
  const MotionSizes<S> of = motion_sizes<S>(contact, data);
  if (contact.pair) return data.pair->terms(k, 0) * of.of_point + data.pair->terms(k, 1) * of.turning;
  return k < 3 ? of.of_point : of.turning;
}

}  // namespace manycontact
