#pragma once
#include "manycontact/contact/rows.hpp"

namespace manycontact::internal {

/// The sizes of all terms that a contact's a0 is computed from [m/s^2, rad/s^2]: accelerations (gravity in them),
/// products of velocities, and what gains answer. Their error is a difference of placements, as good as these are.
inline double row_terms(const Contact& c, const ContactData<double>& d) {
  const auto largest = [](const auto& x) { return x.cwiseAbs().maxCoeff(); };
  const double v = std::max(largest(d.vA), largest(d.vB));
  return largest(d.aA) + largest(d.aB) + v * v + std::abs(c.beta) * v +
         std::abs(c.alpha) * (1 + largest(d.aMA.p) + largest(d.bMA.p) + largest(c.B.placement.p));
}

}  // namespace manycontact::internal
