#pragma once
// The contacts of a scene as one matrix and one vector, and their forces on the bodies, for code with equations of its
// own, such as a whole-body controller:
//
//     J a + a0 = 0        M a + h = S^T u + J^T f

#include <span>

#include "manycontact/model/scene.hpp"

namespace manycontact {

/// Computes the dense Jacobian J of the active contacts at q (nq). Its rows are those of the contacts in the scene's
/// order, each in its contact's reference frame (detail/contact/rows.hpp); it has nv columns. `active` has one flag per
/// contact; if it is empty, the flags of the scene are used. The function computes the kinematics and allocates the
/// result at each call. Throws std::invalid_argument for wrong sizes. Thread-safe.
Eigen::MatrixXd contact_jacobian(const Scene& scene, const ConstVectorRef& q, const std::vector<char>& active = {});

/// Computes the bias a0 of the constraint rows at q (nq) and v (nv) [m/s^2, rad/s^2]: dJ/dt v plus the stabilisation
/// terms, alpha times the error and beta times J v. It has one entry per row of contact_jacobian, computes the
/// kinematics at each call, and allocates. Throws std::invalid_argument for wrong sizes. Thread-safe.
Eigen::VectorXd contact_bias_acceleration(const Scene& scene, const ConstVectorRef& q, const ConstVectorRef& v,
                                          const std::vector<char>& active = {});

/// Computes the wrenches on bodies at q (nq) and v (nv) of contact forces, of external wrenches, and of springs and
/// dampers between points. The contact forces are `f`, with rows and `f_offset` as in Solution; `f_offset` is -1 if a
/// contact is not active. `wrenches` has the external wrenches as `SceneData::wrenches`, or is empty for those of the
/// scene. The result has one wrench per joint, robot by robot, in the child frames: the fext of rnea
/// (algorithm/rigid_body.hpp). With it rnea(q, v, a) returns the motor torques alone, and joint_wrench the load of
/// joints. NaN if the ends of a spring coincide. Allocates. Throws std::invalid_argument for wrong sizes. Thread-safe.
std::vector<Vec6<double>> forces_on_bodies(const Scene& scene, const ConstVectorRef& q, const ConstVectorRef& v,
                                           const ConstVectorRef& f, const std::vector<int>& f_offset,
                                           std::span<const Vec6<double>> wrenches = {});
/// Computes the wrenches of the contact forces alone.
std::vector<Vec6<double>> contact_forces_on_bodies(const Scene& scene, const ConstVectorRef& q, const ConstVectorRef& f,
                                                   const std::vector<int>& f_offset);

}  // namespace manycontact
