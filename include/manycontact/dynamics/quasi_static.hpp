#pragma once
#include "manycontact/dynamics/data.hpp"

namespace manycontact {

/// Torques u (scene.nu) that hold the scene still at q: the u part of the minimum-norm least-squares solution of
/// [S^T J^T] [u; f] = h(q, 0), S selecting the actuated joints, per island, active contacts only. N m (N for prismatic).
/// NaN for an island whose q solve() would refuse. Uses `data` for kinematics; a later derivative needs a new solve.
/// Source: Crocoddyl, DifferentialActionModelContactFwdDynamics::quasiStatic.
Eigen::VectorXd quasi_static(const Scene& scene, const Eigen::Ref<const Eigen::VectorXd>& q, SceneData& data);

/// The same with torques on all velocity coordinates, floating bases included (scene.nv).
Eigen::VectorXd quasi_static_tau(const Scene& scene, const Eigen::Ref<const Eigen::VectorXd>& q, SceneData& data);

/// As the first, with the scene's own active flags.
Eigen::VectorXd quasi_static(const Scene& scene, const Eigen::Ref<const Eigen::VectorXd>& q);

}  // namespace manycontact
