#pragma once
// A command of the program: what it takes, and what runs it.

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
  std::string operands;  // operands other than options, for the usage
  std::string summary;   // one line
  std::vector<Option> options;
  std::string help;                  // after the options
  int (*run)(const Arguments&);      // null: another program in this folder executes it
  bool (*by_processes)() = nullptr;  // whether the program manycontact-mpi does it this time
  const char* beside = nullptr;      // the program's name
};

const Command& solve_command();
const Command& inspect_command();
const Command& simulate_command();
const Command& batch_command();
const Command& view_command();

/// Commands of the programs manycontact-chart and manycontact-optimize, which need more packages or time to build;
/// their `run` is null here.
const Command& chart_command();
const Command& stability_command();
const Command& export_command();
const Command& optimize_command();
int run_chart(const Arguments& arguments);
int run_stability(const Arguments& arguments);
int run_export(const Arguments& arguments);
int run_optimize(const Arguments& arguments);

/// The one operand, SCENE unless it has another name. Throws UsageError.
std::string scene_operand(const Arguments& arguments, const std::string& name = "SCENE");

/// Before hours of work: the file that an option names can be written, or is standard output (-). Throws InputError.
void check_writable(const std::string& path, const std::string& option);
/// UsageError where a file that an option names is one that is read.
void check_unread(const std::string& option, const std::string& file, const std::vector<std::string>& read);
/// UsageError where one of the options `written` names a file that is read, or the file, or standard output, of
/// another one.
void check_files(const Arguments& arguments, const std::vector<std::string>& read,
                 const std::vector<std::string>& written);
/// UsageError where one of the files `names` that an option writes into a folder is one of the others.
void check_folder(const std::string& option, const std::string& folder, const std::vector<std::string>& names,
                  const std::vector<std::string>& others);
/// Whether one of the options `written` names standard output. Then nothing else is printed there.
bool is_standard_output(const Arguments& arguments, const std::vector<std::string>& written);

/// --method, --order and --precision, and their values. Throws UsageError.
Option method_option();
Option order_option();
Option precision_option();
Options solver_options(const Arguments& arguments);

/// "usage: manycontact solve SCENE [--method M] ...", one line.
std::string usage(const Command& command);
/// The whole help of a command.
std::string help(const Command& command);

}  // namespace manycontact::cli
