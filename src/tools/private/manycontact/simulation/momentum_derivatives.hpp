#pragma once
// Derivatives of the momentum correction at the end of a step (detail/simulation/momentum.hpp). With C a group's centre
// of mass, P its momentum and L its angular momentum about C, the end q+, v+ of a step satisfies
//
//     C(q+) = C+        P(q+, v+) = P+        L(q+, v+) = L+
//
// The solve gives q~, v~. Then the group is moved by a displacement d and the velocity (u, w) of a rigid motion:
//
// clang-format off
//     dq+ = T dq~ + E dd                          dd   = dC+ - C_q T dq~
//     dv+ = dv~ + A_q dq+ + A [du; dw]            m du = dP+ - P_q dq+ - P_v (dv~ + A_q dq+)
//                                               I_C dw = dL+ - L_q dq+ - L_v (dv~ + A_q dq+)
// clang-format on
//
// E and A express a displacement and a velocity of the group in the coordinates of its free joints; subscripts q and v
// are derivatives. T is the identity except for free joints on rotating bodies. Coordinate j has the motion subspace
// column S_j, carries bodies with momentum h_j and inertia Y_j, and the parent body of its joint has the velocity V:
//
//     dh/dv_j = Y_j S_j        dh/dq_j = S_j x* h_j - Y_j (S_j x V)        dC/dq_j = linear part of Y_j S_j / m
//
// with x, x* the cross products of a motion with a motion and with a momentum. (A displacement by S_j rotates all
// velocities of the carried bodies, but not V.) Derivatives are in tangent space.

#include <Eigen/SparseCore>

#include "manycontact/detail/simulation/momentum.hpp"

namespace manycontact {

/// Workspace for derivatives of a scene's groups with respect to n numbers. The first 2 nv of these are q and v.
struct FreeMotionDerivatives {
  FreeMotionDerivatives(const Scene& scene, const FreeGroups& groups, Eigen::Index n);

  struct OfGroup {                  // derivatives of a group with respect to the n numbers
    std::vector<int> robots;        // robots with bodies of the group
    Eigen::MatrixXd next;           // 9 x n: derivatives of C+, P+, L+; set by differentiate_begin
    Eigen::MatrixXd h_q, h_v, C_q;  // 6, 6, 3 x nv: derivatives of the current P, L and C; only columns of `robots`
    Eigen::MatrixXd added;          // 9 x n: derivatives of C at the end and of the added u, w
  };
  std::vector<OfGroup> groups;  // one entry per group of FreeGroups::groups; empty for a group tied to the world
  struct Carried {              // bodies of one group that a joint carries, about the group's reference point
    Inertia<double> Y;
    Vec6<double> h;
  };
  std::vector<Carried> carried;  // workspace: one entry per body of a robot
  Eigen::MatrixXd turned;        // 3 x n: workspace
};

/// Computes the derivatives of C+, P+, L+ of begin_free_motion with respect to [q v | w]; kin must be at q, v. dtau_dx
/// (nv x 2 nv) and dtau_dw (nv x nw) are derivatives of tau(x, w) with x = (q, v). Allocates nothing.
void differentiate_begin(const Scene& scene, const Eigen::SparseMatrix<double>& dtau_dx,
                         const Eigen::SparseMatrix<double>& dtau_dw, const ConstVectorRef& tau, double h,
                         const std::vector<Kinematics<double>>& kin, FreeGroups& groups, FreeMotionDerivatives& d);

/// Transforms F (2 nv x n) from derivatives of the state before end_free_motion to derivatives of q, v after it. kin is
/// workspace. Allocates nothing.
void differentiate_end(const Scene& scene, const Eigen::VectorXd& q, const Eigen::VectorXd& v,
                       std::vector<Kinematics<double>>& kin, FreeGroups& groups, FreeMotionDerivatives& d,
                       Eigen::MatrixXd& F);

}  // namespace manycontact
