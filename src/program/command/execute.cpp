#include "execute.hpp"

#include <sys/resource.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <stdexcept>

namespace manycontact::cli {

namespace fs = std::filesystem;

namespace {

// A word of a shell's command.
std::string quoted(const std::string& word) {
  std::string out = "'";
  for (char c : word) out += c == '\'' ? "'\\''" : std::string(1, c);
  return out + "'";
}

}  // namespace

Printed run_and_read(const std::vector<std::string>& words, const std::string& redirection) {
  std::string command = "exec";
  for (const std::string& word : words) command += " " + quoted(word);
  std::FILE* pipe = popen((command + redirection).c_str(), "r");
  Printed out;
  if (!pipe) return out;
  char part[1 << 16];
  for (std::size_t n = 0; (n = std::fread(part, 1, sizeof part, pipe)) > 0;) out.text.append(part, n);
  out.status = pclose(pipe);
  return out;
}

std::string program_beside(const std::string& name) {
  return (fs::read_symlink("/proc/self/exe").parent_path() / name).string();
}

int execute_program(const std::string& name, const std::string& command, const std::vector<std::string>& words,
                    const std::string& how) {
  const std::string path = program_beside(name);
  std::vector<char*> argv{const_cast<char*>(path.c_str()), const_cast<char*>(command.c_str())};
  for (const std::string& word : words) argv.push_back(const_cast<char*>(word.c_str()));
  argv.push_back(nullptr);
  execv(path.c_str(), argv.data());
  throw std::runtime_error(command + " is done by another program, " + path + ", which cannot be run: " + how);
}

void restart_without_blas_threads(char** argv) {
  rlimit addresses{};
  if (getrlimit(RLIMIT_AS, &addresses) != 0 || addresses.rlim_cur == RLIM_INFINITY) return;
  if (!std::getenv("OPENBLAS_NUM_THREADS") && setenv("OPENBLAS_NUM_THREADS", "1", 1) == 0)
    execv("/proc/self/exe", argv);  // if this fails, the process continues
}

}  // namespace manycontact::cli
