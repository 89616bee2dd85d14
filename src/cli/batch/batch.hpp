#pragma once
// `manycontact batch`, in one process or in several.

#include "../program/arguments.hpp"
#include "team.hpp"

namespace manycontact::cli {

/// The command, as a member of that team. Returns the exit status.
int run_batch(const Arguments& arguments, Team& team);

/// Whether this process is one of several that mpirun started.
bool under_mpirun();

}  // namespace manycontact::cli
