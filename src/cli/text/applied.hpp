#pragma once
#include <iosfwd>

#include "manycontact/io/scene_file.hpp"

namespace manycontact::cli {

/// Pushes and springs at the file's q and v: where they act, how long springs are, and the forces. Nothing where the
/// scene has none.
void print_applied_forces(std::ostream& out, const SceneFile& file);

}  // namespace manycontact::cli
