#pragma once
// Products with the derivatives of one contact, without the matrices (forward and reverse mode of contact/rows.hpp).

#include "manycontact/algorithm/rnea_products.hpp"
#include "manycontact/contact/rows.hpp"

namespace manycontact {

/// Along a direction in which A's and B's bodies vary by `a`, `b` (in their tree frames; `b` zero for the world): dr2,
/// the change of x's rows with W turning along (rows of the contact), and dF, the change of the force on A in A's axes,
/// including that it is carried along with A. rows: at the solution's accelerations. f: the contact's force.
void contact_tangent(const Contact& contact, const ContactData<double>& rows, const BodyVariation& a,
                     const BodyVariation& b, const Eigen::Ref<const Eigen::VectorXd>& f,
                     Eigen::Ref<Eigen::VectorXd> dr2, Vec6<double>& dF);

/// Adds the gradients of -w^T J^T f + l^T r2 to the adjoints of A's and B's bodies, in their tree frames. uA, uB:
/// virtual velocities of the bodies under w. l: rows of the contact.
void contact_adjoint(const Contact& contact, const ContactData<double>& rows, const Vec6<double>& uA,
                     const Vec6<double>& uB, const Eigen::Ref<const Eigen::VectorXd>& f,
                     const Eigen::Ref<const Eigen::VectorXd>& l, BodyVariation& a, BodyVariation& b);

}  // namespace manycontact
