#pragma once
// A program of several commands.

#include "command.hpp"

namespace manycontact::cli {

/// Finds the command that the first word names, runs it on the others, and turns what went wrong into one line on
/// standard error and an exit status.
int run_program(const std::vector<Command>& commands, const std::vector<std::string>& words);

}  // namespace manycontact::cli
