#pragma once
#include "view.hpp"

namespace manycontact::cli {

/// The states of a CSV in the columns of `simulate`, one by one: t, q:*, v:* of this scene in any order;
/// violation_position and violation_velocity where it has them. Other columns are left out. With `forces`, a CSV with t
/// and f:left[0] ... of all contacts: the forces of states at the same t; a contact whose are all 0 is not active then.
/// Throws InputError: a file cannot be read, a column is missing, a cell is no finite number, t does not grow, forces
/// at no state's time.
void read_trajectory(const std::string& path, const std::optional<std::string>& forces, const Scene& scene,
                     Recording& recording);

}  // namespace manycontact::cli
