#pragma once

#include <string_view>

#include "arguments.hpp"
#include "manycontact/kkt/options.hpp"

namespace manycontact::cli {

enum Exit {
  kExitOk = 0,       // ok, redundant, inconsistent
  kExitUnsound = 1,  // regularised, failed; out of memory
  kExitUsage = 2,    // bad usage or bad input; output that cannot be written
};

struct Command {
  std::string name;
  std::string operands;  // the operands as the usage shows them
  std::string summary;   // a description in one line
  std::vector<Option> options;
  std::string help;    // text that follows the options
  std::string beside;  // name of a program in the same folder, which executes the command if `run` is null
  int (*run)(const Arguments&) = nullptr;
};

/// Reads the command `name` from commands.txt. If `run` is null, a separately built program executes the command.
Command command(const std::string& name, int (*run)(const Arguments&) = nullptr);
std::string_view commands_text();  // returns commands.txt, which is embedded in the program

int run_solve(const Arguments& arguments);
int run_inspect(const Arguments& arguments);
int run_simulate(const Arguments& arguments);
int run_batch(const Arguments& arguments);
int run_view(const Arguments& arguments);
int run_chart(const Arguments& arguments);
int run_stability(const Arguments& arguments);
int run_export(const Arguments& arguments);
int run_optimize(const Arguments& arguments);

/// Returns the only operand, which messages call `name`. Throws UsageError if there is none or more than one.
std::string scene_operand(const Arguments& arguments, const std::string& name = "SCENE");

/// Checks that an option's file can be written or is standard output (-), before a long computation. Throws InputError.
void check_writable(const std::string& path, const std::string& option);
/// Throws UsageError if the file of an option is one of the files in `read`, which the command reads.
void check_unread(const std::string& option, const std::string& file, const std::vector<std::string>& read);
/// Throws UsageError if an option in `written` names a file in `read`, or the output of another option in `written`.
void check_files(const Arguments& arguments, const std::vector<std::string>& read,
                 const std::vector<std::string>& written);
/// Throws UsageError if one of the files `names` that an option writes into `folder` is also in `others`.
void check_folder(const std::string& option, const std::string& folder, const std::vector<std::string>& names,
                  const std::vector<std::string>& others);
void make_folder(const std::string& folder);  // Creates a folder unless it exists. Throws InputError if this fails.
/// Returns whether one of the options `written` names standard output, so that nothing else may be printed there.
bool is_standard_output(const Arguments& arguments, const std::vector<std::string>& written);

Options solver_options(const Arguments& arguments);  // Reads --method, --order and --precision. Throws UsageError.
/// Returns the text with {methods}, {orders} and {precisions} replaced by the lists of their names.
std::string with_names(std::string text);

/// Runs the command that the first word names. Prints an exception as one line on standard error. Returns exit status.
int run_program(const std::vector<Command>& commands, const std::vector<std::string>& words);

/// Returns the usage in one line, such as "usage: manycontact solve SCENE [--method M] ...".
std::string usage(const Command& command);
std::string help(const Command& command);

}  // namespace manycontact::cli
