#include "python.hpp"

#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <sstream>
#include <stdexcept>

#include "../command/execute.hpp"
#include "manycontact/io/input_error.hpp"

namespace manycontact::cli {

namespace {

constexpr int kCannotWrite = 3;  // exit status of the scripts, which then print the file's name and the reason

// A word of a shell's command.
std::string quoted(const std::string& word) {
  std::string out = "'";
  for (char c : word) out += c == '\'' ? "'\\''" : std::string(1, c);
  return out + "'";
}

}  // namespace

Python find_python() {
  const char* path = std::getenv("PATH");
  std::istringstream folders(path ? path : "/usr/local/bin:/usr/bin:/bin");
  Python found;
  for (std::string folder; !found.draws && std::getline(folders, folder, ':');) {
    const std::string python = folder + "/python3";
    if (access(python.c_str(), X_OK) != 0) continue;
    found.draws = std::system((quoted(python) + " -c 'import matplotlib' 2>/dev/null").c_str()) == 0;
    if (found.draws || found.path.empty()) found.path = python;
  }
  return found;
}

std::string script_path(const std::string& name) { return program_beside("../share/manycontact/charts/" + name); }

std::string run_python(const Python& python, const std::string& script, const std::vector<std::string>& arguments) {
  std::string command = quoted(python.path) + " -B " + quoted(script);
  for (const std::string& argument : arguments) command += " " + quoted(argument);
  std::FILE* pipe = popen(command.c_str(), "r");
  if (!pipe) throw std::runtime_error(std::string("python3 cannot be started: ") + std::strerror(errno));
  std::string printed;
  char part[4096];
  for (std::size_t n = 0; (n = std::fread(part, 1, sizeof part, pipe)) > 0;) printed.append(part, n);
  const int status = pclose(pipe);
  if (WIFEXITED(status) && WEXITSTATUS(status) == kCannotWrite) {
    const std::size_t end = printed.find('\n');
    throw InputError(printed.substr(0, end), 1, printed.substr(end + 1, printed.rfind('\n') - end - 1));
  }
  if (status != 0) throw std::runtime_error(python.path + " failed in " + script);
  return printed;
}

}  // namespace manycontact::cli
