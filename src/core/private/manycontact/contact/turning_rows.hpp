#pragma once
// Rows of 1D and 2D contacts whose axes rotate. detail/contact/rows.hpp has the acceleration of A seen from B', picked
// along the rows (as Crocoddyl): the rate of that velocity along axes that are fixed in B'. With w the rotation of the
// rows' axes seen from B' (nu_ang in A's axes; minus that of B' in the world's) the rate of J v is
//
//     d(W nu)/dt = W (nudot_lin + nu_ang x nu_lin) - W (w x nu_lin)
//
// Rows of 3D contacts and others leave nothing of nu_lin, so that the two constrain the same. Here the rows leave the
// part of nu_lin across them, and only that counts: what is along them vanishes if the contact is satisfied.

#include "manycontact/detail/contact/rows.hpp"

namespace manycontact::internal {

/// Velocities across the rows are rounding errors up to this part of the velocities they are differences of.
constexpr double kAcrossRows = 1e-12;

/// Whether a contact leaves a direction of motion of its point, so that its rows may turn while A moves across them.
inline bool leaves_directions(const Contact& contact) {
  return contact.type == ContactType::k1D || contact.type == ContactType::k2D;
}

/// W (w x nu_across): by how much the acceleration of contact_rows differs from the rate of J v. Zero if A does not
/// move across the rows. Call it after contact_rows.
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
