#pragma once
// Derivatives of a step's end by detail/simulation/momentum.hpp. With C a group's centre of mass, P its momentum and L
// its angular momentum about C, the end q+, v+ of a step obeys
//
//     C(q+) = C+        P(q+, v+) = P+        L(q+, v+) = L+
//
// and differs from q~, v~ before the group is moved by a displacement d and the velocity (u, w) of a rigid motion:
//
// clang-format off
//     dq+ = T dq~ + E dd                          dd   = dC+ - C_q T dq~
//     dv+ = dv~ + A_q dq+ + A [du; dw]            m du = dP+ - P_q dq+ - P_v (dv~ + A_q dq+)
//                                               I_C dw = dL+ - L_q dq+ - L_v (dv~ + A_q dq+)
// clang-format on
//
// E and A are what a displacement and a velocity of the group are in the coordinates of its free joints; T is 1 but for
// free joints on bodies that turn. For a coordinate j with motion S_j, h_j and Y_j the momentum and the inertia of what
// of the group it carries, and V the velocity of the body before its joint:
//
//     dh/dv_j = Y_j S_j        dh/dq_j = S_j x* h_j - Y_j (S_j x V)        dC/dq_j = linear part of Y_j S_j / m
//
// (a displacement by S_j carries the velocities behind it along, but for V). All on the tangent space.

#include <Eigen/SparseCore>

#include "manycontact/detail/simulation/momentum.hpp"

namespace manycontact {

/// Workspace for derivatives of one scene's groups with respect to n numbers; the first 2 nv are the step's q and v.
struct FreeMotionDerivatives {
  /// groups: those of `scene`; n: as above.
  FreeMotionDerivatives(const Scene& scene, const FreeGroups& groups, Eigen::Index n);

  /// Derivatives of a group with respect to the n numbers.
  struct OfGroup {
    std::vector<int> robots;        // the robots that have bodies of the group
    Eigen::MatrixXd next;           // 9 x n: derivatives of C+, P+, L+; set by differentiate_begin
    Eigen::MatrixXd h_q, h_v, C_q;  // 6, 6, 3 x nv: derivatives of the current P, L and C; columns: those of `robots`
    Eigen::MatrixXd added;          // 9 x n: derivatives of C at the end and of the added u, w
  };
  std::vector<OfGroup> groups;  // one entry per group of FreeGroups::groups; without memory if tied to the world
  /// Inertia and momentum of the bodies of one group that a joint carries, about the group's reference.
  struct Carried {
    Inertia<double> Y;
    Vec6<double> h;
  };
  std::vector<Carried> carried;  // workspace: one entry per body of a robot
  Eigen::MatrixXd turned;        // 3 x n: workspace
};

/// After begin_free_motion, with kin at q, v still: by [q v | w], where tau(x, w) are the torques it was given, nv x 2
/// nv and nv x nw. Allocates nothing.
void differentiate_begin(const Scene& scene, const Eigen::SparseMatrix<double>& dtau_dx,
                         const Eigen::SparseMatrix<double>& dtau_dw, const ConstVectorRef& tau, double h,
                         const std::vector<Kinematics<double>>& kin, FreeGroups& groups, FreeMotionDerivatives& d);

/// After end_free_motion, which came to q, v. F: 2 nv x n, in: derivatives of the state it was given; out: of q, v.
/// kin: scratch. Allocates nothing.
void differentiate_end(const Scene& scene, const Eigen::VectorXd& q, const Eigen::VectorXd& v,
                       std::vector<Kinematics<double>>& kin, FreeGroups& groups, FreeMotionDerivatives& d,
                       Eigen::MatrixXd& F);

}  // namespace manycontact
