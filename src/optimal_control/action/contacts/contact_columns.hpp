#pragma once
// Copies a contact's rows to the matrices of its data, and compares the rows of two contacts.

#include "manycontact/action/contact.hpp"
#include "manycontact/detail/contact/derivatives.hpp"

namespace manycontact::internal {

/// The first columns of A's robot and of B's robot in a matrix with one column per velocity coordinate.
struct EndColumns {
  int a = 0, b = 0;
};

/// Calls use(column in the matrix, column k of the support) for each column of a contact's support.
template <class Use>
void each_column(const EndColumns& first, const ContactSupport& support, Use&& use) {
  int k = 0;
  for (const int i : support.a) use(first.a + i, k++);
  for (const int i : support.b) use(first.b + i, k++);
}

/// Computes out = [da0/dq | da0/dv] from the rows and their derivatives. Each half has out.cols() / 2 columns.
void set_drift_derivatives(const EndColumns& first, const ContactSupport& support, const ContactData<double>& rows,
                           const ContactDerivatives& d, Eigen::MatrixXd& out);

/// Returns whether two contacts have rows of the same structure: type, bodies, axis, and placement of A.
inline bool have_same_rows(const Contact& a, const Contact& b) {
  const auto on_same_body = [](const Attachment& one, const Attachment& other) {
    return one.robot == other.robot && one.joint == other.joint;
  };
  return a.type == b.type && on_same_body(a.A, b.A) && on_same_body(a.B, b.B) && a.axis == b.axis &&
         a.A.placement.p == b.A.placement.p && a.A.placement.R == b.A.placement.R;
}

template <class Wrenches>
void unit_wrenches(ContactType type, const Vec3<double>& axis, Wrenches& P) {
  P.setZero(6, contact_rows(type));
  switch (type) {
    case ContactType::k1D:
      P.template topRows<3>() = axis;
      break;
    case ContactType::k2D:
      P(0, 0) = P(2, 1) = 1;
      break;
    case ContactType::k5D:
      P.template topLeftCorner<3, 3>().setIdentity();
      P.template bottomRightCorner<3, 2>() = across(axis).transpose();
      break;
    case ContactType::k3D:
    case ContactType::k6D:
      P.setIdentity();
      break;
  }
}

}  // namespace manycontact::internal
