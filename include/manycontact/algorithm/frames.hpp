#pragma once
// Placement, velocity, acceleration and Jacobian of a frame fixed on a robot's body. Reference frames as in Pinocchio:
// local: the frame's own axes and origin; world: world axes, at the world's origin; local_world_aligned: world axes, at
// the frame's origin.

#include "manycontact/algorithm/kinematics.hpp"

namespace manycontact {

enum class FrameAxes { kLocal, kWorld, kLocalWorldAligned };

/// oMf in the world. joint, placement: of the frame on its joint's body (model/model.hpp); joint -1: the fixed base,
/// whose placement in the world is `base`. After forward_kinematics.
template <class S>
SE3<S> frame_placement(const Kinematics<S>& kin, const SE3<double>& base, int joint, const SE3<double>& placement);

/// Spatial velocity. After forward_accelerations.
template <class S>
Vec6<S> frame_velocity(const Kinematics<S>& kin, const SE3<double>& base, int joint, const SE3<double>& placement,
                       FrameAxes axes);

/// Spatial acceleration, gravity not subtracted: with kin at qdd = nullptr the bias acceleration dJ/dt v.
/// After forward_accelerations.
template <class S>
Vec6<S> frame_acceleration(const Kinematics<S>& kin, const SE3<double>& base, int joint, const SE3<double>& placement,
                           FrameAxes axes);

/// Classical acceleration, that of the frame's origin as a point: spatial + w x v on the linear part.
template <class S>
Vec6<S> frame_classical_acceleration(const Kinematics<S>& kin, const SE3<double>& base, int joint,
                                     const SE3<double>& placement, FrameAxes axes);

/// J (6 x nv) with frame_velocity = J v. Columns that do not move the frame are set to zero.
template <class S>
void frame_jacobian(const Model& model, const Kinematics<S>& kin, const SE3<double>& base, int joint,
                    const SE3<double>& placement, FrameAxes axes, Mat6XRef<S> J);

}  // namespace manycontact
