#pragma once
// Derivatives of one contact's rows and of its share in the dynamics, in A's axes. With s_i the column of J_l (sign
// included), P1, P2, P3 the likewise placed and signed Psid_i, Psidd_i, Psid_i + Sd_i (algorithm/rnea_derivatives.hpp),
// v_B = X v_B', a_B = X a_B', and e = R_A^T (p_A - p_B') the error of a point:
//
// clang-format off
//   d nu/dq_i      = P1 + s_i x v_B
//   d nudot/dq_i   = P2 - (v_A + v_B) x P1 + s_i x a_B - v_A x (s_i x v_B)
//   d nu/dv_i      = s_i
//   d nudot/dv_i   = P3 - (v_A + v_B) x s_i
//   d log6(G)/dq_i = Jlog6(log6(G)) s_i
//   d e/dq_i       = s_i,lin - s_i,ang x e
// clang-format on
//
// for the joints between A and B'; for joints above both, all are zero. A world-aligned frame turns with W: for every
// joint above A, with th_i the angular part of A's motion, dW/dq_i y = W (th_i x y) on both parts of y.
// Derived from Singh, Russell, Wensing, arXiv 2105.05102, eq. for da/dq; relative motion as in contact/rows.hpp.

#include "manycontact/algorithm/rnea_derivatives.hpp"
#include "manycontact/contact/rows.hpp"

namespace manycontact {

/// Numbers of one contact. Allocated once.
template <class S>
struct ContactDerivativesOf {
  ContactDerivativesOf() = default;                                                                 // of nothing
  ContactDerivativesOf(const Scene& scene, const Contact& contact, const ContactSupport& support);  // room

  std::vector<int> chain_a, chain_b;         // all coordinates above A and above B', ascending
  Mat6X<S> dx_dq, dx_dv;                     // 6 x cols: of x (without the turning of W)
  Eigen::Matrix<S, 3, Eigen::Dynamic> turn;  // 3 x chain_a: th_i, where `turns`
  Mat6X<S> S_b;                              // 6 x chain_b (between bodies): columns of B' in A's axes
  Vec6<S> F = Vec6<S>::Zero();               // W^T f: force on A at its origin, in A's axes
  Vec6<S> x = Vec6<S>::Zero();               // x at the accelerations of kin
  bool turns = false;                        // the frame is world-aligned
};
using ContactDerivatives = ContactDerivativesOf<double>;

/// th x y on both parts of y: how a world-aligned frame's y turns when A turns by th (a column of `turn`).
template <class S>
Vec6<S> turned(const Vec3<S>& th, const Vec6<S>& y) {
  Vec6<S> out;
  out << th.cross(y.template head<3>()), th.cross(y.template tail<3>());
  return out;
}

/// Fills `d`. kinA, kinB: after forward_accelerations with the solution's accelerations; termsA, termsB: Psid, Psidd,
/// Sv of the same robots; f: the contact's force in its own frame; data: by contact_rows at the same accelerations.
template <class S>
void contact_derivatives(const Contact& contact, const ContactSupport& support, const Kinematics<S>& kinA,
                         const Kinematics<S>* kinB, const RneaDerivativesOf<S>& termsA,
                         const RneaDerivativesOf<S>* termsB, const ConstVecRef<S>& f, const ContactData<S>& data,
                         ContactDerivativesOf<S>& d);

}  // namespace manycontact
