#pragma once
#include <Eigen/SparseCore>

#include "manycontact/dynamics/data.hpp"

namespace manycontact {

/// Computes torques u (scene.nu entries, N m or N) that keep the scene at rest at q (scene.nq entries). u is part of
/// the minimum-norm least-squares solution of
///
///     [S^T J^T] [u; f] = h(q, 0) - J_F^T w - tau_s(q, 0),
///
/// where S selects the actuated joints, J contains the active contacts, w are the external wrenches `data.pushes`, and
/// tau_s are the torques of the springs. If the scene cannot be kept at rest, the residual is not zero: solve with the
/// returned torques and look at the accelerations.
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

/// Computes the torques with the active flags and wrenches of the scene. It makes data of its own, and so allocates.
Eigen::VectorXd quasi_static(const Scene& scene, const ConstVectorRef& q);

}  // namespace manycontact
