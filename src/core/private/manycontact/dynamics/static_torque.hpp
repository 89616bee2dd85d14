#pragma once
// Torques for rest at the last solve's q with its contact forces, external wrenches and springs:
//
//     tau = g(q) - J^T f - tau_s(q, 0, w)        tau_s: of algorithm/applied_forces.hpp

#include "manycontact/algorithm/applied_forces.hpp"
#include "manycontact/detail/algorithm/rnea_derivatives.hpp"
#include "manycontact/dynamics/data.hpp"
#include "manycontact/dynamics/derivatives.hpp"

namespace manycontact {

/// Kinematics of the scene at rest, in addition to the solve's; allocate once.
struct StaticTorque {
  explicit StaticTorque(const Scene& scene);
  std::vector<Kinematics<double>> kin;             // one entry per robot
  std::vector<RneaDerivatives> terms;              // one entry per robot
  std::vector<std::vector<Vec6<double>>> fext, f;  // one entry per robot: njoints contact forces (tree frame), scratch
  AppliedForces<double> applied;                   // external wrenches and springs, at rest
  AppliedScratch scratch;                          // scratch for the derivatives of `applied`
  Eigen::VectorXd tau;                             // nv: set by static_torque
  Eigen::VectorXd tau_s;                           // nv: torques of `applied`
  Eigen::VectorXd l, wq, wv;                       // nv: scratch; l is zero between uses
};

/// Sets s.tau (nv), with data.wrenches and, if `contacts`, contact forces, after update_kinematics at q (nq) or a
/// solve, which contact forces need.
void static_torque(const Scene& scene, const SceneData& data, const double* q, bool contacts, StaticTorque& s);

/// Computes d(s.tau)/dq of an island (nv x nv) on the tangent space, with f constant in each contact's frame. Call it
/// after static_torque with the same `contacts`, after crba, and after differentiate if `contacts` is true.
void static_torque_derivative(const Scene& scene, const SceneData& data, std::size_t island, bool contacts,
                              StaticTorque& s, Eigen::Ref<IslandDerivatives::Panel, 0, Eigen::OuterStride<>> out);

}  // namespace manycontact
