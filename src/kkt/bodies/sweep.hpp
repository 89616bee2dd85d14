#pragma once
// One step of the sweep from the leaves.

#include "manycontact/kkt/bodies/ldl.hpp"

namespace manycontact {

/// What b leaves of node i for its parent.
void backward_step(const BodySystem& system, BodyLdl& ldl, const BodyVectors& b, int i);

}  // namespace manycontact
