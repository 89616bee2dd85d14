#pragma once
// Derivatives of inverse dynamics with respect to q (on the tangent space) and v. They are tree-sparse: tau_i depends
// on q_j and v_j only if one coordinate is an ancestor of the other.
//
// Let p be the parent of j's joint, Psid_j = v_p x S_j, Psidd_j = a_p x S_j + v_p x Psid_j and Sd_j = v_j x S_j. Let
// Yc, 2B and f be sums over the subtree of i's joint. For an ancestor j of i:
//
// clang-format off
//     dtau_i/dq_j = S_i^T (2B Psid_j + Yc Psidd_j)        dtau_j/dq_i = S_j^T (2B Psid_i + Yc Psidd_i + S_i x* f)
//     dtau_i/dv_j = S_i^T (2B S_j + Yc (Psid_j + Sd_j))   dtau_j/dv_i = S_j^T (2B S_i + Yc (Psid_i + Sd_i))
// clang-format on
//
// In an inertial frame 2B = (v x*) Y - Y (v x) + (Y v) xbar* = [0, -2[l]x; 0, C] has only twelve numbers, l and C.
// Source: Singh, Russell, Wensing, arXiv 2105.05102, table I; the form of 2B is ours.

#include <span>

#include "manycontact/detail/algorithm/kinematics.hpp"

namespace manycontact {

/// The derivatives, packed as M (detail/algorithm/crba.hpp): one entry for each i and ancestor j. Symbols: file header.
template <class S>
struct RneaDerivativesOf {
  explicit RneaDerivativesOf(const Model& model);  // allocates the workspace of this robot

  Mat6X<S> Psid, Psidd, Sv;           // 6 x nv: Psid, Psidd, Psid + Sd
  std::vector<Vec3<S>> l;             // njoints: linear momentum of the subtree
  std::vector<Mat3<S>> C;             // njoints: the block C of the subtree's 2B
  std::vector<Vec6<S>> f;             // njoints: force through the joint
  std::vector<S> dq_lower, dv_lower;  // dtau_i/dq_j, dtau_i/dv_j
  std::vector<S> dq_upper, dv_upper;  // dtau_j/dq_i, dtau_j/dv_i
};
using RneaDerivatives = RneaDerivativesOf<double>;

/// Computes the derivatives, after forward_kinematics, forward_accelerations with qdd, and crba, which gives Yc. fext:
/// njoints external forces in the tree frame, each fixed to its body, or empty.
template <class S>
void rnea_derivatives(const Model& model, const Kinematics<S>& kin, const std::vector<Inertia<S>>& Yc,
                      const std::vector<Vec6<S>>& fext, RneaDerivativesOf<S>& d);

/// Expands the packed lower and upper entries of one derivative into a dense nv x nv matrix.
inline void unpack_tree(const Model& model, std::span<const double> lower, std::span<const double> upper,
                        Eigen::Ref<Eigen::MatrixXd> out) {
  out.setZero();
  for (int i = 0; i < model.nv; ++i) {
    int at = model.M_begin[i];
    for (int j = i; j >= 0; j = model.dof_parent[j], ++at) {
      out(j, i) = upper[at];
      out(i, j) = lower[at];
    }
  }
}

}  // namespace manycontact
