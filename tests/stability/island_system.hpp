#pragma once
// K of each island is built as dense blocks in any precision, from the rigid-body algorithms and the contacts' rows
// alone: it serves to judge the layers above, which assemble and factorize it.

#include <vector>

#include "stability/problem.hpp"

namespace manycontact::test {

/// K = [M J^T; J -delta I], a0, and the places of the island's coordinates in the scene.
template <class S>
struct IslandSystem {
  std::vector<int> v, f;  // per velocity coordinate and per contact row of the island: its place in data.a, in data.f
  MatX<S> M, J;
  VecX<S> a0;

  int size() const { return static_cast<int>(v.size() + f.size()); }
};

/// Flags of the scene's contacts.
std::vector<char> active(const Scene& scene);

/// Returns the systems in the order of find_islands. S: double or Quad.
template <class S>
std::vector<IslandSystem<S>> island_systems(const Problem& p);

}  // namespace manycontact::test
