#pragma once
// Other programs in the folder of this one.

#include <string>
#include <vector>

namespace manycontact::cli {

/// Path of the program `name` in this program's folder, whether it exists or not.
std::string program_beside(const std::string& name);

/// Becomes the program `name` in this program's folder, with `command` and `words` as its arguments. It returns only by
/// an exception: if the program is missing or cannot be executed, it throws std::runtime_error with `how` to get it.
int execute_program(const std::string& name, const std::string& command, const std::vector<std::string>& words,
                    const std::string& how);

/// The output of a program that has ended, and its status as waitpid has it; -1: it could not be started.
struct Printed {
  std::string text;
  int status = -1;
};
/// Runs the program words[0] with `input` on its standard input, and returns its standard output. silent: its standard
/// error is discarded.
Printed run_and_read(const std::vector<std::string>& words, const std::string& input = "", bool silent = false);

/// If the address space is limited (ulimit -v), restarts this program without OpenBLAS threads, which would otherwise
/// request memory for ever. They start before main() does, so that only an environment variable can prevent them.
void restart_without_blas_threads(char** argv);

}  // namespace manycontact::cli
