#pragma once
// Rows of 1D and 2D contacts whose axes rotate. As in Crocoddyl, they select components of the rate of A's relative
// velocity along axes fixed in B'. Let w be the angular velocity of the rows' axes relative to B': nu_ang for A's axes,
// minus that of B' for the world's. The rate of J v is (nu, W: detail/contact/rows.hpp)
//
//     d(W nu)/dt = W (nudot_lin + nu_ang x nu_lin) - W (w x nu_lin)
//
// For other contacts nu_lin vanishes if the contact is satisfied, and the term with w vanishes, too. For 1D and 2D only
// the component of nu_lin orthogonal to the rows' axes matters; the others vanish if the contact is satisfied.

#include "manycontact/detail/contact/rows.hpp"

namespace manycontact::internal {

/// Relative velocities orthogonal to the rows' axes are rounding errors if they are below this fraction of their terms.
constexpr double kAcrossRows = 1e-12;

/// Whether a contact leaves its point free in some direction, so that its rows may rotate while A moves across them.
inline bool leaves_directions(const Contact& contact) {
  return contact.type == ContactType::k1D || contact.type == ContactType::k2D;
}

/// Returns W (w x nu_across), the rows' acceleration minus the rate of J v; nu_across: nu_lin orthogonal to their axes.
inline Eigen::Vector2d turning_of_rows(const Contact& contact, const ContactData<double>& d) {
  Eigen::Vector2d out = Eigen::Vector2d::Zero();
  if (!leaves_directions(contact)) return out;
  const auto W = d.W.leftCols<3>();
  const Vec3<double> nu = d.nu.head<3>(), nu_across = nu - W.transpose() * (W * nu);
  const Vec3<double> w = rows_turn(contact) ? Vec3<double>(-d.vB.tail<3>()) : Vec3<double>(d.nu.tail<3>());
  const double arms = d.aMA.p.norm() + d.bMA.p.norm();
  const double size =
      d.vA.head<3>().norm() + d.vB.head<3>().norm() + arms * (d.vA.tail<3>().norm() + d.vB.tail<3>().norm());
  if (nu_across.norm() > kAcrossRows * size) out.head(d.W.rows()) = W * w.cross(nu_across);
  return out;
}

}  // namespace manycontact::internal
