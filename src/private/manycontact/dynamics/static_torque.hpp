#pragma once
// Torques that would hold the scene still at the last solve's q with its contact forces: g(q) - J^T f.

#include "manycontact/algorithm/rnea_derivatives.hpp"
#include "manycontact/dynamics/data.hpp"
#include "manycontact/dynamics/derivatives.hpp"

namespace manycontact {

/// Kinematics of the scene at rest, beside those of the solve. Allocated once.
struct StaticTorque {
  explicit StaticTorque(const Scene& scene);       // room for its robots
  std::vector<Kinematics<double>> kin;             // per robot
  std::vector<RneaDerivatives> terms;              // per robot
  std::vector<std::vector<Vec6<double>>> fext, f;  // per robot: njoints contact forces (tree frame), scratch
  Eigen::VectorXd tau;                             // nv: by static_torque
};

/// s.tau = g(q) - J^T f (nv), or g(q) alone without `contacts`. After forward_kinematics of data's robots and, with
/// `contacts`, a solve; throws std::logic_error where that went in lanes and `complete` was not called since.
void static_torque(const Scene& scene, const SceneData& data, bool contacts, StaticTorque& s);

/// Its derivative with respect to q, on the tangent space, f held constant in each contact's own frame: an island's
/// nv x nv. After static_torque with the same `contacts`; crba and, with `contacts`, differentiate.
void static_torque_derivative(const Scene& scene, const SceneData& data, std::size_t island, bool contacts,
                              StaticTorque& s, Eigen::Ref<IslandDerivatives::Panel, 0, Eigen::OuterStride<>> out);

}  // namespace manycontact
