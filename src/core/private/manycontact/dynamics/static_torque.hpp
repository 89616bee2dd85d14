#pragma once
// Torques that keep the scene at rest at the q of the last solve, with contact forces f, wrenches w and springs:
//
//     tau = g(q) - J^T f - tau_s(q, 0, w)        tau_s: torques of wrenches and springs (algorithm/applied_forces.hpp)

#include "manycontact/algorithm/applied_forces.hpp"
#include "manycontact/detail/algorithm/rnea_derivatives.hpp"
#include "manycontact/dynamics/data.hpp"
#include "manycontact/dynamics/derivatives.hpp"

namespace manycontact {

/// The workspace of static torques, with kinematics of the scene at rest. Allocate it once.
struct StaticTorque {
  explicit StaticTorque(const Scene& scene);
  std::vector<Kinematics<double>> kin;             // one entry per robot
  std::vector<RneaDerivatives> terms;              // one entry per robot
  std::vector<std::vector<Vec6<double>>> fext, f;  // one entry per robot: njoints contact forces (tree frame), scratch
  AppliedForces<double> applied;                   // external wrenches and springs at zero velocity
  AppliedScratch scratch;                          // scratch for the derivatives of `applied`
  Eigen::VectorXd tau;                             // nv: set by static_torque
  Eigen::VectorXd tau_s;                           // nv: torques of `applied`
  Eigen::VectorXd l, wq, wv;                       // nv: scratch; l is zero between uses
};

/// Computes the static torque s.tau (nv) at q (nq), with data.wrenches and, if `contacts`, with contact forces. Call it
/// after update_kinematics or, if `contacts`, after a solve.
void static_torque(const Scene& scene, const SceneData& data, const double* q, bool contacts, StaticTorque& s);

/// Computes the derivative of s.tau with respect to q for one island (nv x nv), on the tangent space and at constant f
/// in each contact's frame. Call it after static_torque with equal `contacts`, after crba, and, if `contacts`, after
/// differentiate.
void static_torque_derivative(const Scene& scene, const SceneData& data, std::size_t island, bool contacts,
                              StaticTorque& s, Eigen::Ref<IslandDerivatives::Panel, 0, Eigen::OuterStride<>> out);

}  // namespace manycontact
