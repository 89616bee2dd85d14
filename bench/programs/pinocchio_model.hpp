#pragma once
// Converts a scene to a model of Pinocchio, for its own program and Crocoddyl's.

#include <pinocchio/multibody/data.hpp>
#include <pinocchio/multibody/model.hpp>

#include "bodies.hpp"

namespace manycontact::bench {

namespace pin = pinocchio;

inline pin::SE3 place(const SE3<double>& M) { return {M.R, M.p}; }

/// Returns a model with our order of joints, and therefore our coordinates.
pin::Model model_of(const Posed& scene);

}  // namespace manycontact::bench
