#include <fcntl.h>
#include <unistd.h>

#include <csignal>
#include <exception>
#include <iostream>
#include <new>

#include "../text/table.hpp"
#include "command.hpp"
#include "execute.hpp"
#include "interrupt.hpp"
#include "manycontact/io/input_error.hpp"
#include "manycontact/sparse/memory.hpp"
#include "manycontact/version.hpp"

namespace manycontact::cli {
namespace {

std::string overview(const std::vector<Command>& commands) {
  std::string text = "manycontact: contact forward dynamics of many robots by sparse factorization\n\n";
  for (const Command& command : commands) text += usage(command) + "\n    " + command.summary + "\n";
  text +=
      "usage: manycontact --help | --version\n"
      "\n"
      "manycontact COMMAND --help describes a command. Exit status: 0 there is a solution; 1 there is none, or only "
      "that\n"
      "of a neighbouring problem; 2 bad usage, bad input or output.\n";
  return text;
}

int complain(const std::string& what, const std::string& hint, int status) {
  std::cerr << "manycontact: " << printable(what) << "\n";
  if (!hint.empty()) std::cerr << hint << "\n";
  return status;
}

int run(const Command& command, const std::vector<std::string>& words) {
  for (const std::string& word : words) {
    if (word == "--") break;
    if (word != "--help" && word != "-h") continue;
    std::cout << help(command);
    return kExitOk;
  }
  if (!command.run) {
    const std::string& program = command.beside;
    return execute_program(program, command.name, words,
                           program == "manycontact-mpi"
                               ? "batch uses that program under mpirun, and `./run build --mpi` builds it"
                           : program == "manycontact-chart" ? "`./run build --chart` builds that program"
                                                            : "`./run build` builds that program");
  }
  try {
    return command.run(Arguments(command.options, words));
  } catch (const UsageError& error) {
    return complain(command.name + ": " + error.what(), usage(command), kExitUsage);
  }
}

int dispatch(const std::vector<Command>& commands, const std::vector<std::string>& words) {
  std::string names;
  for (const Command& command : commands) names += (names.empty() ? "" : "|") + command.name;
  const std::string hint = "usage: manycontact " + names + " SCENE [options], manycontact --help";
  if (words.empty()) return complain("a command is missing", hint, kExitUsage);
  if (words[0] == "--help" || words[0] == "-h" || words[0] == "--version") {
    if (words.size() > 1) return complain("nothing is expected after " + words[0], hint, kExitUsage);
    std::cout << (words[0] == "--version" ? std::string("manycontact " MANYCONTACT_VERSION "\n") : overview(commands));
    return kExitOk;
  }
  for (const Command& command : commands)
    if (command.name == words[0]) return run(command, {words.begin() + 1, words.end()});
  const char* kind = words[0].starts_with("-") ? "unknown option '" : "unknown command '";
  return complain(kind + words[0] + "'", hint, kExitUsage);
}

// Opens /dev/null for closed standard descriptors, so that no file takes their numbers. Writing to them still fails.
void hold_standard_descriptors() {
  int file = 0;
  do file = open("/dev/null", O_RDONLY);
  while (file >= 0 && file <= STDERR_FILENO);
  if (file >= 0) close(file);
}

}  // namespace

int run_program(const std::vector<Command>& commands, const std::vector<std::string>& words) {
  hold_standard_descriptors();
  hear_signals();
  std::signal(SIGXFSZ, SIG_IGN);  // makes writing beyond the file size limit fail with an error
  try {
    const int status = dispatch(commands, words);
    if (std::cout.flush()) return status;
    return complain("cannot write to standard output", "", kExitUsage);
  } catch (const InputError& error) {
    return complain(error.what(), "", kExitUsage);
  } catch (const sparse::TooLarge& error) {
    return complain(std::string("out of memory: ") + error.what(), "", kExitUnsound);
  } catch (const std::bad_alloc&) {
    return complain("out of memory", "", kExitUnsound);
  } catch (const std::exception& error) {
    return complain(error.what(), "", kExitUnsound);
  } catch (...) {
    return complain("an unknown error occurred", "", kExitUnsound);
  }
}

}  // namespace manycontact::cli
