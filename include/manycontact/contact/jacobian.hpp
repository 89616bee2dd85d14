#pragma once
// The active contacts of a scene as one matrix J and one vector a0, and contact forces f as wrenches on bodies. These
// functions are for programs with their own equations, such as whole-body controllers:
//
//     J a + a0 = 0        M a + h = S^T u + J^T f

#include <span>

#include "manycontact/model/scene.hpp"

namespace manycontact {

/// Computes the dense Jacobian J of the active contacts at q (nq), with nv columns. Rows are in the order of the
/// scene's contacts, each contact in its reference frame (detail/contact/rows.hpp). `active` has one flag per contact;
/// if it is empty, the flags of the scene are used. Each call computes the kinematics and allocates the result. Throws
/// std::invalid_argument for wrong sizes. Thread-safe.
Eigen::MatrixXd contact_jacobian(const Scene& scene, const ConstVectorRef& q, const std::vector<char>& active = {});

/// Computes the bias a0 of the constraint rows at q (nq) and v (nv) [m/s^2, rad/s^2]: dJ/dt v plus the stabilisation,
/// alpha times the position error and beta times J v. There is one entry per row of contact_jacobian. Each call
/// computes the kinematics and allocates. Throws std::invalid_argument for wrong sizes. Thread-safe.
Eigen::VectorXd contact_bias_acceleration(const Scene& scene, const ConstVectorRef& q, const ConstVectorRef& v,
                                          const std::vector<char>& active = {});

/// Computes the wrenches that contact forces, external wrenches, and springs and dampers between points exert on
/// bodies, at q (nq) and v (nv). The contact forces are `f`, with rows and `f_offset` as in Solution (-1: contact not
/// active). `wrenches` has the external wrenches as `SceneData::wrenches`; if empty, the scene's are used. The result
/// has one wrench per joint, robot by robot, in child frames: the argument fext of rnea (algorithm/rigid_body.hpp).
/// With this fext, rnea(q, v, a) returns the motor torques alone, and joint_wrench the load of joints. The result is
/// NaN if the ends of a spring coincide. Allocates. Throws std::invalid_argument for wrong sizes. Thread-safe.
std::vector<Vec6<double>> forces_on_bodies(const Scene& scene, const ConstVectorRef& q, const ConstVectorRef& v,
                                           const ConstVectorRef& f, const std::vector<int>& f_offset,
                                           std::span<const Vec6<double>> wrenches = {});
/// Computes the result of forces_on_bodies for the contact forces alone.
std::vector<Vec6<double>> contact_forces_on_bodies(const Scene& scene, const ConstVectorRef& q, const ConstVectorRef& f,
                                                   const std::vector<int>& f_offset);

}  // namespace manycontact
