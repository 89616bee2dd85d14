#pragma once
#include "manycontact/dynamics/data.hpp"

namespace manycontact::internal {

/// Returns `count` copies of a scene in one scene; copy k has the k-th part of concatenated vectors.
Scene copies_of(const Scene& scene, int count);

/// Returns how many states fill a SIMD batch, after prepare; 1 if one state does, or without SIMD batches.
int states_side_by_side(const SceneData& data);

}  // namespace manycontact::internal
