#pragma once
// What a contact's a0 is computed from: the scale by which its rounding is judged.

#include "../../workspace.hpp"

namespace manycontact::internal {

/// The sizes of all terms that a contact's a0 is computed from [m/s^2, rad/s^2]: accelerations (gravity in them),
/// products of velocities, and what gains answer. Their error is a difference of placements, as good as these are.
double row_terms(const Scene& scene, const Workspace& work, int contact);

}  // namespace manycontact::internal
