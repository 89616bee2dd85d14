#pragma once
// Pushes and springs of scenes that are made of others.

#include <vector>

#include "manycontact/model/scene.hpp"

namespace manycontact {

/// Takes pushes and springs away: what is left moves by gravity, motors and contacts alone.
void drop_applied_forces(Scene& scene);

/// Adds those of `from` whose robots are in `to`, as they are. robot_at: per robot of `from` its number in `to`, -1: it
/// is not there. Their names may be there already.
void take_applied_forces(const Scene& from, const std::vector<int>& robot_at, Scene& to);

}  // namespace manycontact
