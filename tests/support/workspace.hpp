#pragma once
// Access of tests to the workspace of a scene's data.

#include "dynamics/internal.hpp"
#include "manycontact/dynamics/shapes.hpp"

namespace manycontact::test {

/// Returns how often an island's K, whole or robot by robot, was factorized for the current solution and its results.
inline int factorizations_of(const SceneData& data, std::size_t i) {
  return data_solved(data).workspace->islands.at(i)->factorizations;
}

/// Returns the number of shapes analysed so far.
inline std::size_t shapes_analysed(const SceneData& data) { return data_solved(data).workspace->shapes.size(); }

/// Sets the predicted seconds of work per thread from which a call uses threads; 0: always.
inline void wake_threads_for(SceneData& data, double seconds) {
  if (data.workspace->reduction) wake_threads_for(*data.workspace->reduction->data, seconds);
  data.workspace->worth_a_thread = seconds;
}

/// Sets the largest memory of contact sets that are not in use [bytes].
inline void limit_pool(SceneData& data, std::size_t bytes) {
  if (data.workspace->reduction) limit_pool(*data.workspace->reduction->data, bytes);
  data.workspace->pool.most = bytes;
}

}  // namespace manycontact::test
