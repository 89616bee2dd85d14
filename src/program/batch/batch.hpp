#pragma once
// `manycontact batch`, in one process or in several.

#include "../command/arguments.hpp"
#include "communicator.hpp"

namespace manycontact::cli {

/// The command, as a member of that communicator. Returns the exit status.
int run_batch(const Arguments& arguments, Communicator& communicator);

/// Whether this process is one of several that mpirun started.
bool under_mpirun();

}  // namespace manycontact::cli
