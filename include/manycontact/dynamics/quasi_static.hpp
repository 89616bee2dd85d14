#pragma once
#include <Eigen/SparseCore>

#include "manycontact/dynamics/data.hpp"

namespace manycontact {

/// Torques u (scene.nu) that hold the scene still at q: the u part of the minimum-norm least-squares solution of
/// [S^T J^T] [u; f] = h(q, 0) - J_F^T w - tau_s(q, 0), S selecting the actuated joints, active contacts only, under
/// data.pushes and the scene's springs. N m (N for prismatic). A q that solve() would refuse: std::invalid_argument;
/// NaN for an island refused otherwise. Throws std::length_error where a deep tree's joint-space terms are too many
/// (kkt/choose.hpp: kMostJointSpace). Uses `data` for kinematics; a later derivative needs a new solve.
/// Source: Crocoddyl, DifferentialActionModelContactFwdDynamics::quasiStatic.
Eigen::VectorXd quasi_static(const Scene& scene, const Eigen::Ref<const Eigen::VectorXd>& q, SceneData& data);

/// The same for controls u that give the torques tau0 + B u: [B J^T] [u; f] = h(q, 0) - J_F^T w - tau_s(q, 0) - tau0.
/// B: scene.nv rows.
Eigen::VectorXd quasi_static(const Scene& scene, const Eigen::Ref<const Eigen::VectorXd>& q,
                             const Eigen::Ref<const Eigen::VectorXd>& tau0, const Eigen::SparseMatrix<double>& B,
                             SceneData& data);

/// As the first, with the scene's own active flags.
Eigen::VectorXd quasi_static(const Scene& scene, const Eigen::Ref<const Eigen::VectorXd>& q);

}  // namespace manycontact
