#pragma once
// Derivatives of one contact's constraint rows and of its terms in the dynamics, in A's axes. Let s_i be column i of
// J_l (sign included), and P1, P2, P3 the columns Psid_i, Psidd_i, Psid_i + Sd_i of
// detail/algorithm/rnea_derivatives.hpp, in A's axes and with the sign of s_i. Let v_B = X v_B', a_B = X a_B', and e =
// R_A^T (p_A - p_B') the position error. Then
//
// clang-format off
//     d nu/dq_i      = P1 + s_i x v_B
//     d nudot/dq_i   = P2 - (v_A + v_B) x P1 + s_i x a_B - v_A x (s_i x v_B)
//     d nu/dv_i      = s_i
//     d nudot/dv_i   = P3 - (v_A + v_B) x s_i
//     d log6(G)/dq_i = Jlog6(log6(G)) s_i
//     d e/dq_i       = s_i,lin - s_i,ang x e
// clang-format on
//
// for the joints between A and B'; other derivatives are zero. The axes of a world-aligned frame rotate relative to A.
// For each joint above A, with the angular part th_i of A's motion, dW/dq_i y = W (th_i x y), applied to both parts of
// y. Derived from Singh, Russell, Wensing, arXiv 2105.05102, eq. for da/dq; for nu, x, G, W, X see
// detail/contact/rows.hpp.

#include "manycontact/detail/algorithm/rnea_derivatives.hpp"
#include "manycontact/detail/contact/rows.hpp"

namespace manycontact {

/// The derivatives of one contact. Allocated once.
template <class S>
struct ContactDerivativesOf {
  ContactDerivativesOf() = default;  // empty
  /// Allocates the workspace.
  ContactDerivativesOf(const Scene& scene, const Contact& contact, const ContactSupport& support);

  std::vector<int> chain_a, chain_b;         // the coordinates above A, and above B', ascending; both contain
                                             // the joints above A and B'
  Mat6X<S> dx_dq, dx_dv;                     // 6 x cols: derivatives of x without the rotation of W
  Eigen::Matrix<S, 3, Eigen::Dynamic> turn;  // 3 x chain_a: th_i of A's joints, if `turns`
  Mat6X<S> S_b;                              // 6 x chain_b (B on a body): motions of B' in A's axes
  Vec6<S> F = Vec6<S>::Zero();               // W^T f: force on A at its origin, in A's axes
  Vec6<S> x = Vec6<S>::Zero();               // x at the accelerations of the solution
  bool turns = false;                        // whether the frame is world-aligned
};
using ContactDerivatives = ContactDerivativesOf<double>;

/// Computes th x y for both parts of y: the rate of a vector y of a world-aligned frame, relative to A, if A rotates by
/// th (a column of `turn`).
template <class S>
Vec6<S> turned(const Vec3<S>& th, const Vec6<S>& y) {
  Vec6<S> out;
  out << th.cross(y.template head<3>()), th.cross(y.template tail<3>());
  return out;
}

/// Computes the derivatives `d`. `kinA`, `kinB`: kinematics after forward_accelerations with the accelerations of the
/// solution; `kinB` is nullptr if B is in the world. `termsA`, `termsB`: Psid, Psidd, Sv of these robots. `f`: the
/// contact's force in its reference frame. `data`: from contact_rows at the same accelerations.
template <class S>
void contact_derivatives(const Contact& contact, const ContactSupport& support, const Kinematics<S>& kinA,
                         const Kinematics<S>* kinB, const RneaDerivativesOf<S>& termsA,
                         const RneaDerivativesOf<S>* termsB, const ConstVecRef<S>& f, const ContactData<S>& data,
                         ContactDerivativesOf<S>& d);

}  // namespace manycontact
