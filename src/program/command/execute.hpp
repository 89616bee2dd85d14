#pragma once

#include <string>
#include <vector>

namespace manycontact::cli {

/// Returns the path of a program `name` in this program's folder, even if there is no such program.
std::string program_beside(const std::string& name);

/// Replaces this process by the program `name` of this program's folder, with `command` and `words` as its arguments.
/// Throws std::runtime_error if the program is missing or cannot be executed; its message says `how` to install it.
int execute_program(const std::string& name, const std::string& command, const std::vector<std::string>& words,
                    const std::string& how);

/// The output of a program that has ended, and its status from waitpid; -1: it could not be started.
struct Printed {
  std::string text;
  int status = -1;
};
/// Runs the program words[0] with `input` as standard input, and returns its output. silent: discards standard error.
Printed run_and_read(const std::vector<std::string>& words, const std::string& input = "", bool silent = false);

/// If the address space is limited (ulimit -v), restarts this program without OpenBLAS threads, which would request
/// memory for ever. These threads start before main(): only an environment variable can prevent them.
void restart_without_blas_threads(char** argv);

}  // namespace manycontact::cli
