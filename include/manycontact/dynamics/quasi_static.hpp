#pragma once
#include <Eigen/SparseCore>

#include "manycontact/dynamics/data.hpp"

namespace manycontact {

/// Computes torques u (scene.nu entries, N m or N) that keep the scene at rest at q (scene.nq entries). u is part of
/// the minimum-norm least-squares solution of
///
///     [S^T J^T] [u; f] = h(q, 0) - J_F^T w - tau_s(q, 0),
///
/// where S selects the actuated joints, J contains the active contacts, w are the external wrenches `data.wrenches`,
/// and tau_s are the torques of the springs. If the scene cannot be kept at rest, the residual is not zero; see
/// Unbalanced.
///
/// The result is NaN for islands that cannot be computed. Throws std::invalid_argument if q has a wrong size or is
/// refused by solve(). Throws std::length_error for trees too deep for the joint-space inertia (2^22 terms). `data` is
/// used as workspace for kinematics, so that derivatives need a new solve afterwards. Thread-safe for distinct data.
/// Source: Crocoddyl, DifferentialActionModelContactFwdDynamics::quasiStatic.
Eigen::VectorXd quasi_static(const Scene& scene, const ConstVectorRef& q, SceneData& data);

/// Computes controls u that give the torques tau0 + B u: [B J^T] [u; f] = h(q, 0) - J_F^T w - tau_s(q, 0) - tau0. Here
/// tau0 has scene.nv entries, and B has scene.nv rows and one column per control. Throws as the first overload does.
Eigen::VectorXd quasi_static(const Scene& scene, const ConstVectorRef& q, const ConstVectorRef& tau0,
                             const Eigen::SparseMatrix<double>& B, SceneData& data);

/// A robot that no torques keep at rest, and its coordinate with the largest residual of the equation above. The
/// residual is compared with the size of gravity and applied forces on each coordinate.
struct Unbalanced {
  int robot = 0;
  int dof = -1;          // one of that robot's velocity coordinates
  double force = 0;      // size of the residual there [N; N m if it is angular]
  bool angular = false;  // whether the coordinate is an angle
};

/// Computes the torques with the active flags and wrenches of the scene. It makes data of its own, and so allocates.
/// unbalanced: set to the robots that these torques and the contacts do not keep at rest, unless it is nullptr. A part
/// of a load up to 1e-6 is attributed to rounded numbers in files.
Eigen::VectorXd quasi_static(const Scene& scene, const ConstVectorRef& q,
                             std::vector<Unbalanced>* unbalanced = nullptr);

}  // namespace manycontact
