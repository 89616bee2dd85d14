#pragma once
// External wrenches and springs of scenes that are made of other scenes.

#include <vector>

#include "manycontact/model/scene.hpp"

namespace manycontact {

/// Removes external wrenches and springs: the scene then moves by gravity, motors and contacts alone.
void drop_applied_forces(Scene& scene);

/// Adds those of `from` whose robots are in `to`, as they are. robot_at: per robot of `from` its number in `to`, -1: it
/// is not there. Their names may be there already.
void take_applied_forces(const Scene& from, const std::vector<int>& robot_at, Scene& to);

}  // namespace manycontact
