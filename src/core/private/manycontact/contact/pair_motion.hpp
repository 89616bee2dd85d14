#pragma once
// The bias a0 of a pair (contact/pair_rows.hpp), and its derivatives with respect to its bodies' relative motion.

#include "manycontact/contact/pair_rows.hpp"

namespace manycontact {

/// Returns W_m x, the components that the rows of member m select from a motion x in its frame A's axes.
template <class S>
Eigen::Matrix<S, Eigen::Dynamic, 1, 0, 6, 1> rows_of_member(const Contact& m, const Vec6<S>& x) {
  Eigen::Matrix<S, Eigen::Dynamic, 1, 0, 6, 1> out(m.rows());
  switch (m.type) {
    case ContactType::k1D:
      out[0] = m.axis.cast<S>().dot(x.template head<3>());
      break;
    case ContactType::k2D:
      out[0] = x[0], out[1] = x[2];
      break;
    case ContactType::k5D:
      out.template head<3>() = x.template head<3>();
      out.template tail<2>() = across(m.axis).cast<S>() * x.template tail<3>();
      break;
    default:
      out = x.head(m.rows());
      break;
  }
  return out;
}

/// The bias acceleration of a contact of a pair without nudot, and its derivatives. nu: relative velocity of A and B';
/// G: placement of A in B'; alpha, beta: gains; e: position error; r: rotation between the axes:
///     6D: alpha log6(G) + beta nu,   points: nu_ang x nu_lin + alpha e + beta nu_lin,
///     5D: as points, and alpha r + beta nu_ang
template <class S>
struct MemberMotion {
  const Contact& c;
  Vec6<S> nu;
  SE3<S> G;

  MemberMotion(const ContactData<S>& d, const PairRows& pair, std::size_t m)
      : c(pair.members[m]), nu(d.pair->A[m].act_inverse(d.nu)) {
    if (c.alpha != 0) G = d.pair_B[m].inverse() * (d.G * d.pair->A[m]);
  }

  Vec6<S> drift() const {
    Vec6<S> x = S(c.beta) * nu;
    if (c.type != ContactType::k6D) x.template head<3>() += nu.template tail<3>().cross(nu.template head<3>());
    if (c.alpha != 0) x += contact_error<S>(c, G, S(c.alpha));
    return x;
  }
  Vec6<S> by_motion(const Vec6<S>& dnu) const {  // d(drift)/d(nu) dnu
    Vec6<S> x = S(c.beta) * dnu;
    if (c.type != ContactType::k6D)
      x.template head<3>() +=
          dnu.template tail<3>().cross(nu.template head<3>()) + nu.template tail<3>().cross(dnu.template head<3>());
    return x;
  }
  /// Returns the derivative of `drift` along a displacement s of A. log: log6_derivative(G), used for 6D only.
  Vec6<S> by_displacement(const Vec6<S>& s, const Mat6<S>& log) const {
    const S alpha(c.alpha);
    if (c.type == ContactType::k6D) return alpha * (log * s);
    Vec6<S> x = Vec6<S>::Zero();
    const Vec3<S> e = G.R.transpose() * G.p, w = s.template tail<3>();
    x.template head<3>() = alpha * (s.template head<3>() - w.cross(e));
    if (c.type == ContactType::k5D) {
      const Vec3<S> n = c.axis.template cast<S>(), m = G.R.transpose() * n;
      x.template tail<3>() = alpha * (m.dot(n) * w - w.dot(n) * m);
    }
    return x;
  }
};

template <class S>
void pair_motion(const Contact& pair, ContactData<S>& d);  // sets d.x, W, a0, left, given d.nu, nudot, G

/// The derivatives of a pair's x with respect to nu and to a displacement of A, at constant nudot (6 x 6 each).
template <class S>
struct PairSlopes {
  Mat6<S> by_motion = Mat6<S>::Zero(), by_displacement = Mat6<S>::Zero();
};
template <class S>
PairSlopes<S> pair_slopes(const Contact& pair, const ContactData<S>& d);

}  // namespace manycontact
