#pragma once

#include <string>
#include <vector>

namespace manycontact::cli {

/// Returns the path of a program `name` in the folder of this program, even if there is no such program.
std::string program_beside(const std::string& name);

/// Replaces this process by the program `name` in the folder of this program, with `command` and `words` as arguments.
/// Throws std::runtime_error if that program is missing or cannot be executed. how: how to install it, for the message.
int execute_program(const std::string& name, const std::string& command, const std::vector<std::string>& words,
                    const std::string& how);

/// The output of a program that has ended, and its status from waitpid. The status is -1 if it could not be started.
struct Printed {
  std::string text;
  int status = -1;
};
/// Runs the program words[0] with `input` as standard input and returns its output. If silent, discards standard error.
Printed run_and_read(const std::vector<std::string>& words, const std::string& input = "", bool silent = false);

/// If the address space is limited (ulimit -v), restarts this program without threads of OpenBLAS, which would request
/// memory forever. Only an environment variable can prevent these threads, because they start before main().
void restart_without_blas_threads(char** argv);

}  // namespace manycontact::cli
