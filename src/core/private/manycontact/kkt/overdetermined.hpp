#pragma once
// Islands with many times more contact rows than coordinates: a thousand points on one sole. Nearly all rows depend on
// the others, and among rows of one body a sparse factor is full: its cost is cubic in the contacts, that of the dense
// method, which decomposes J of few columns, is linear.

#include "manycontact/kkt/island.hpp"
#include "manycontact/sparse/tolerances.hpp"

namespace manycontact {

/// Whether kAuto takes the dense method.
inline bool overdetermined(const Island& island) {
  return island.nc >= tolerance::kOverdetermined && island.nc > tolerance::kTimesOverdetermined * island.nv;
}

/// Whether the sparse methods with an order give way to it too: their factors would take more memory than anybody
/// means to spend, and are not analysed.
inline bool too_full_for_sparse(const Island& island) {
  return island.nc >= tolerance::kTooFull && overdetermined(island);
}

}  // namespace manycontact
