#pragma once
#include "manycontact/dynamics/data.hpp"

namespace manycontact::internal {

/// Returns `count` copies of a scene in one scene; copy k has the k-th part of concatenated vectors.
Scene copies_of(const Scene& scene, int count);

/// Returns how many states fill a SIMD batch; 1 if one state's robots do, or without SIMD batches. Call it after
/// prepare.
int states_side_by_side(const SceneData& data);

}  // namespace manycontact::internal
