#pragma once
// Intermediate results of a solve: islands, K, kinematics, and the Jacobians of contacts. All functions throw
// std::logic_error if there is no solution, or if the solver did not compute the requested result. References remain
// valid until the next call that changes the data.
//
// SIMD batches (`Options::simd_level`) store only accelerations and forces. Functions with an argument `scene` evaluate
// the missing terms, at the cost of evaluating one island or of assembling its K. These functions are thread-safe only
// if the terms exist already. Deep trees, solved by sparse-bodies, have no K, and the members J and Jl of their
// contact_data are NaN.

#include <Eigen/SparseCore>
#include <span>

#include "manycontact/detail/contact/derivatives.hpp"
#include "manycontact/detail/contact/rows.hpp"
#include "manycontact/detail/kkt/island.hpp"
#include "manycontact/dynamics/data.hpp"
#include "manycontact/kkt/options.hpp"

namespace manycontact {

/// Returns whether the current islands are those of data.active and data.options.
bool is_prepared(const SceneData& data);
/// Returns the number of islands, as in data.report.islands. Call it after prepare or solve.
std::size_t island_count(const SceneData& data);
/// Returns the robots and contacts of island i. Call it after prepare or solve.
const Island& solved_island(const SceneData& data, std::size_t i);
/// Returns the number of the island that contains a robot of the scene.
int island_with_robot(const SceneData& data, RobotIndex robot);
/// Returns the method and order that were chosen for island i when it was set up. The island's report contains the
/// method that computed the solution.
Choice chosen_method(const SceneData& data, std::size_t i);
/// Returns K = [M J^T; J -delta I] of island i at the last solve: nv + nc rows, both triangles, in the island's order.
/// Here delta is zero if the damping was below the rounding errors of K (Reason::kDampingLost). Allocates.
Eigen::SparseMatrix<double> kkt_matrix(const Scene& scene, const SceneData& data, std::size_t i);

/// Returns the kinematics of a robot's bodies in the robot's tree frame (detail/algorithm/kinematics.hpp) at the last
/// q, v. The bodies' accelerations are those for zero joint accelerations.
const Kinematics<double>& robot_kinematics(const Scene& scene, const SceneData& data, RobotIndex robot);
/// Returns the inertia of each joint's subtree of bodies in the tree frame [kg, kg m, kg m^2].
std::span<const Inertia<double>> composite_inertias(const Scene& scene, const SceneData& data, RobotIndex robot);
/// Return the packed joint-space inertia (detail/algorithm/crba.hpp), and the bias torques h (nv) [N m, N] of a robot.
std::span<const double> joint_space_inertia(const Scene& scene, const SceneData& data, RobotIndex robot);
const Eigen::VectorXd& bias_torques(const Scene& scene, const SceneData& data, RobotIndex robot);
/// Returns the constraint rows of an active contact: J, a0 and the quantities that they are computed from
/// (detail/contact/rows.hpp).
const ContactData<double>& contact_data(const Scene& scene, const SceneData& data, ContactIndex contact);
/// Returns the velocity coordinates that an active contact acts on.
const ContactSupport& contact_support(const Scene& scene, const SceneData& data, ContactIndex contact);
/// Returns the constraint rows of an active contact, evaluated with the accelerations of the solution. The member a0 of
/// the result is J a + a0, with J and a0 of contact_data. The function contact_derivatives returns the derivatives of
/// these rows. Call both functions after differentiate.
const ContactData<double>& contact_at_solution(const SceneData& data, ContactIndex contact);
const ContactDerivatives& contact_derivatives(const SceneData& data, ContactIndex contact);

/// Computes the placements, velocities and inertias of all robots at q (nq) and v (nv), for robot_kinematics and
/// composite_inertias. Discards the solution. Throws std::invalid_argument for a wrong size, and for q or v that solve
/// would refuse.
void update_kinematics(const Scene& scene, const ConstVectorRef& q, const ConstVectorRef& v, SceneData& data);

}  // namespace manycontact
