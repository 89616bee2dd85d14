#pragma once
// Placement, velocity, acceleration and Jacobian of a frame that is fixed to a robot's body. Reference frames (axes)
// have Pinocchio's meaning:
//
//     local                 the frame's axes, at the frame's origin
//     world                 the world's axes, at the world's origin
//     local_world_aligned   the world's axes, at the frame's origin

#include "manycontact/detail/algorithm/kinematics.hpp"
#include "manycontact/model/scene.hpp"

namespace manycontact {

/// Computes oMf, the frame's placement in the world. `joint` and `placement`: the frame's joint and its placement on
/// the joint's body (model/model.hpp). Joint -1 is the fixed base, whose placement in the world is `base`. Call it
/// after forward_kinematics.
template <class S>
SE3<S> frame_placement(const Kinematics<S>& kin, const SE3<double>& base, int joint, const SE3<double>& placement);

/// Computes the frame's spatial velocity [m/s, rad/s]. Call it after forward_accelerations.
template <class S>
Vec6<S> frame_velocity(const Kinematics<S>& kin, const SE3<double>& base, int joint, const SE3<double>& placement,
                       ReferenceFrame axes);

/// Computes the frame's spatial acceleration [m/s^2, rad/s^2], without gravity. If kin was computed with qdd = nullptr,
/// the result is the bias acceleration dJ/dt v. Call it after forward_accelerations.
template <class S>
Vec6<S> frame_acceleration(const Kinematics<S>& kin, const SE3<double>& base, int joint, const SE3<double>& placement,
                           ReferenceFrame axes);

/// Computes the classical acceleration: the linear part is the acceleration of the frame's origin, spatial + w x v.
template <class S>
Vec6<S> frame_classical_acceleration(const Kinematics<S>& kin, const SE3<double>& base, int joint,
                                     const SE3<double>& placement, ReferenceFrame axes);

/// Computes the frame's J (6 x nv), frame_velocity = J v. Columns of joints that do not move the frame become zero.
template <class S>
void frame_jacobian(const Model& model, const Kinematics<S>& kin, const SE3<double>& base, int joint,
                    const SE3<double>& placement, ReferenceFrame axes, Mat6XRef<S> J);

}  // namespace manycontact
