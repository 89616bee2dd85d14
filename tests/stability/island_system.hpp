#pragma once
// K of each island as dense blocks in any precision, from the rigid-body algorithms and the contacts' rows alone: a
// test of the layers above, which assemble and factorize it.

#include <vector>

#include "stability/problem.hpp"

namespace manycontact::test {

/// K = [M J^T; J -delta I], a0, and the indices of the island's coordinates in the scene.
template <class S>
struct IslandSystem {
  std::vector<int> v, f;  // indices in data.a of the island's velocity coordinates, and in data.f of its contact rows
  MatX<S> M, J;
  VecX<S> a0;

  int size() const { return static_cast<int>(v.size() + f.size()); }
};

/// Returns the scene's flags of active contacts.
std::vector<char> active(const Scene& scene);

/// Returns the systems in the order of find_islands. S: double or Quad.
template <class S>
std::vector<IslandSystem<S>> island_systems(const Problem& p);

}  // namespace manycontact::test
