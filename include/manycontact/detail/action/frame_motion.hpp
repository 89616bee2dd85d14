#pragma once
// The motion of a frame at the x of the last calc, for user-defined residuals and costs:
//
//     data->r = frame_placement(*state_, *data->shared, frame_).p - target_;                              // calc
//     data->Rx.leftCols(nv) = frame_jacobian(*state_, *data->shared, frame_, LOCAL_WORLD_ALIGNED).topRows(3);

#include "manycontact/action/state.hpp"
#include "manycontact/detail/action/collector.hpp"

namespace manycontact {

// The functions throw std::invalid_argument if the state is not a StateMultibody, or has no such frame. shared: the
// member `shared` of the data of a residual or cost.

/// Returns the placement oMf of the frame in the world [m].
SE3<double> frame_placement(const StateAbstract& state, const DataCollector& shared, FrameIndex frame);

/// Returns the frame's spatial velocity, linear part first [m/s, rad/s].
Vec6<double> frame_velocity(const StateAbstract& state, const DataCollector& shared, FrameIndex frame,
                            ReferenceFrame axes = ReferenceFrame::kLocal);

/// Returns the frame's Jacobian J (6 x nv), with frame_velocity = J v. J is also the derivative of the placement with
/// respect to q on the tangent space. Allocates.
Mat6X<double> frame_jacobian(const StateAbstract& state, const DataCollector& shared, FrameIndex frame,
                             ReferenceFrame axes = ReferenceFrame::kLocal);

}  // namespace manycontact
