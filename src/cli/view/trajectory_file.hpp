#pragma once
#include "view.hpp"

namespace manycontact::cli {

/// The states of a CSV in the columns of `simulate`, one by one: t, q:*, v:* of this scene in any order; drift_position
/// and drift_velocity where it has them; f:* (rows of contact forces) where it has those of a contact, an empty cell
/// for one that is not active then. Other columns are left out. Throws InputError: the file cannot be read, a column is
/// missing, a cell is no finite number, t does not grow.
void read_trajectory(const std::string& path, const Scene& scene, Recording& recording);

}  // namespace manycontact::cli
