#pragma once
#include "manycontact/dynamics/data.hpp"

namespace manycontact::internal {

/// A scene `count` times over, one copy after the other: copy k has the k-th part of concatenated vectors.
Scene copies_of(const Scene& scene, int count);

/// How many states fill a SIMD batch: 1 where the robots of one do, or without SIMD batches. After prepare.
int states_side_by_side(const SceneData& data);

}  // namespace manycontact::internal
