#pragma once
// What a solve leaves to be looked at, besides the answer. All throw std::logic_error where what they show was not
// computed; references stay valid until the data's next call. Robots that stood in lanes (Options::lanes) leave nothing
// but the answer, until `complete` is called; sparse-bodies leaves no K, and of contacts neither J nor Jl (NaN).

#include <Eigen/SparseCore>
#include <span>

#include "manycontact/contact/derivatives.hpp"
#include "manycontact/contact/rows.hpp"
#include "manycontact/dynamics/data.hpp"
#include "manycontact/kkt/island.hpp"
#include "manycontact/kkt/options.hpp"

namespace manycontact {

/// After solve: computes what the solution's robots would have left had they not stood in lanes: motions, K, its
/// factor. Throws as differentiate does.
void complete(const Scene& scene, const SceneData& data);

/// Whether the islands at hand are those of data.active and data.options.
bool is_prepared(const SceneData& data);
/// The islands of data.report.islands, after prepare or solve.
std::size_t island_count(const SceneData& data);
const Island& island_of(const SceneData& data, std::size_t i);
/// The number of the island that a robot of the scene is in.
int island_with_robot(const SceneData& data, int robot);
/// The method and order chosen for an island when it was set up; its report says which answered.
Choice choice_of(const SceneData& data, std::size_t i);
/// K = [M J^T; J -delta I] of an island as solved last, both halves; velocities and rows as the island numbers them.
/// delta is zero where the damping was lost (Reason::kDampingLost).
Eigen::SparseMatrix<double> matrix_of(const SceneData& data, std::size_t i);

/// A robot's bodies in its tree frame, at q, v solved at; accelerations are those without forces or torques (qdd = 0).
const Kinematics<double>& kinematics_of(const SceneData& data, int robot);
/// Inertia of each joint's subtree, in the tree frame.
std::span<const Inertia<double>> composite_inertias(const SceneData& data, int robot);
/// Packed joint-space inertia (algorithm/crba.hpp), and bias torques h (nv).
std::span<const double> inertia_of(const SceneData& data, int robot);
const Eigen::VectorXd& bias_of(const SceneData& data, int robot);
/// The rows of an active contact: J, a0 and what they are made of.
const ContactData<double>& contact_of(const SceneData& data, int contact);
/// The coordinates that any contact acts on.
const ContactSupport& support_of(const SceneData& data, int contact);
/// The rows at the solution's accelerations and their derivatives; after differentiate.
const ContactData<double>& contact_at_solution(const SceneData& data, int contact);
const ContactDerivatives& contact_derivatives_of(const SceneData& data, int contact);

/// Places, velocities and inertias of all robots at q (nq), v (nv), for kinematics_of and composite_inertias; gives up
/// the solution. Throws std::invalid_argument on a wrong size, and for a q or v that solve would refuse.
void update_kinematics(const Scene& scene, const Eigen::Ref<const Eigen::VectorXd>& q,
                       const Eigen::Ref<const Eigen::VectorXd>& v, SceneData& data);

}  // namespace manycontact
