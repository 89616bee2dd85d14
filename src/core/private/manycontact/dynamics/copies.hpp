#pragma once
#include "manycontact/dynamics/data.hpp"

namespace manycontact::internal {

/// Returns a scene with `count` copies of the given scene. Vectors of the copies are concatenated.
Scene copies_of(const Scene& scene, int count);

/// Returns the number of states of the scene whose robots together fill a SIMD batch. Returns 1 if one state fills its
/// batches, or without SIMD batches. Call it after prepare.
int states_side_by_side(const SceneData& data);

}  // namespace manycontact::internal
