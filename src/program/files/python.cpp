#include "python.hpp"

#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <sstream>
#include <stdexcept>

#include "../command/execute.hpp"
#include "manycontact/io/input_error.hpp"

namespace manycontact::cli {

namespace {

constexpr int kCannotWrite = 3;  // exit status of a script that cannot write a file and prints its name and the reason

}  // namespace

Python find_python() {
  const char* path = std::getenv("PATH");
  std::istringstream folders(path ? path : "/usr/local/bin:/usr/bin:/bin");
  Python found;
  for (std::string folder; !found.draws && std::getline(folders, folder, ':');) {
    const std::string python = folder + "/python3";
    if (access(python.c_str(), X_OK) != 0) continue;
    found.draws = run_and_read({python, "-c", "import matplotlib"}, "", true).status == 0;
    if (found.draws || found.path.empty()) found.path = python;
  }
  return found;
}

std::string script_path(const std::string& name) { return program_beside("../share/manycontact/charts/" + name); }

std::string run_python(const Python& python, const std::string& script, const std::vector<std::string>& arguments,
                       const std::string& input) {
  std::vector<std::string> words{python.path, "-B", script};
  words.insert(words.end(), arguments.begin(), arguments.end());
  const auto [printed, status] = run_and_read(words, input);
  if (status == -1) throw std::runtime_error(std::string("python3 cannot be started: ") + std::strerror(errno));
  if (WIFEXITED(status) && WEXITSTATUS(status) == kCannotWrite) {
    const std::size_t end = printed.find('\n');
    throw InputError(printed.substr(0, end), 1, printed.substr(end + 1, printed.rfind('\n') - end - 1));
  }
  if (status != 0) throw std::runtime_error("the script " + script + ", run by " + python.path + ", failed");
  return printed;
}

}  // namespace manycontact::cli
