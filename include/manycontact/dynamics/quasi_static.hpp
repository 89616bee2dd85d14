#pragma once
#include <Eigen/SparseCore>

#include "manycontact/dynamics/data.hpp"

namespace manycontact {

/// Computes torques u (scene.nu entries, N m or N) that keep the scene at rest at q (scene.nq entries). u is part of
/// the minimum-norm least-squares solution of
///
///     [S^T J^T] [u; f] = h(q, 0) - J_F^T w - tau_s(q, 0),
///
/// where S selects the actuated joints, J contains the rows of active contacts, and f are contact forces. The torques
/// of gravity are h(q, 0), and those of springs are tau_s. J_F is the Jacobian of the frames of the external wrenches w
/// (`data.wrenches`). If no torques keep the scene at rest, the residual is not zero; see Unbalanced.
///
/// The result is NaN for islands that cannot be computed. Throws std::invalid_argument if q has a wrong size or `solve`
/// would refuse it. Throws std::length_error for trees too deep for the joint-space inertia (2^22 terms). The call
/// discards the solution in `data`, so derivatives need a new solve afterwards. Thread-safe for distinct data.
/// Source: Crocoddyl, DifferentialActionModelContactFwdDynamics::quasiStatic.
Eigen::VectorXd quasi_static(const Scene& scene, const ConstVectorRef& q, SceneData& data);

/// Computes controls u whose torques tau0 + B u keep the scene at rest, from [B J^T] [u; f] = h(q, 0) - J_F^T w -
/// tau_s(q, 0) - tau0. Here tau0 has scene.nv entries, and B has scene.nv rows and one column per control. Throws as
/// the first overload does.
Eigen::VectorXd quasi_static(const Scene& scene, const ConstVectorRef& q, const ConstVectorRef& tau0,
                             const Eigen::SparseMatrix<double>& B, SceneData& data);

/// A robot that no torques keep at rest, and the coordinate with the largest residual of the quasi_static equation,
/// relative to the loads by gravity and applied forces on the coordinate.
struct Unbalanced {
  RobotIndex robot = 0;
  int dof = -1;          // one of that robot's velocity coordinates
  double force = 0;      // size of the residual at this coordinate [N; N m if angular]
  bool angular = false;  // whether the coordinate is an angle
};

/// Computes u as the first overload does, with the active flags and wrenches of the scene, and a new SceneData. The
/// list `unbalanced`, unless nullptr, is set to the robots that u and the contacts do not keep at rest. Residuals up to
/// 1e-6 of the load are attributed to rounded numbers in files.
Eigen::VectorXd quasi_static(const Scene& scene, const ConstVectorRef& q,
                             std::vector<Unbalanced>* unbalanced = nullptr);

}  // namespace manycontact
