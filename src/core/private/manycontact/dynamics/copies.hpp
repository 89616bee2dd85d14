#pragma once
#include "manycontact/dynamics/data.hpp"

namespace manycontact::internal {

/// Returns a scene with `count` copies of the given scene. Vectors of the copies are concatenated.
Scene copies_of(const Scene& scene, int count);

/// Returns the number of states whose robots fill a SIMD batch; 1 without SIMD batches. Call it after prepare.
int states_side_by_side(const SceneData& data);

}  // namespace manycontact::internal
