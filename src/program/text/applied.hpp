#pragma once
#include <iosfwd>

#include "manycontact/io/scene_file.hpp"

namespace manycontact::cli {

/// Prints external wrenches and springs at the file's q and v: points of application, lengths of springs, and forces.
/// Prints nothing if the scene has none.
void print_applied_forces(std::ostream& out, const SceneFile& file);

}  // namespace manycontact::cli
