#include "execute.hpp"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <thread>

namespace manycontact::cli {

namespace fs = std::filesystem;

Printed run_and_read(const std::vector<std::string>& words, const std::string& input, bool silent) {
  std::vector<char*> argv;
  for (const std::string& word : words) argv.push_back(const_cast<char*>(word.c_str()));
  argv.push_back(nullptr);
  Printed out;
  int ends[2];
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0) return out;
  const pid_t child = fork();
  if (child == 0) {
    if (silent) dup2(open("/dev/null", O_WRONLY | O_CLOEXEC), STDERR_FILENO);
    if (dup2(ends[1], STDIN_FILENO) >= 0 && dup2(ends[1], STDOUT_FILENO) >= 0) execv(argv[0], argv.data());
    _exit(127);
  }
  close(ends[1]);
  std::thread writer([&] {
    ssize_t n = 0;
    for (std::size_t at = 0; at < input.size() && n >= 0; at += static_cast<std::size_t>(n))
      n = send(ends[0], input.data() + at, input.size() - at, MSG_NOSIGNAL);
    shutdown(ends[0], SHUT_WR);
  });
  char part[1 << 16];
  for (ssize_t n = 1; child > 0 && (n > 0 || (n < 0 && errno == EINTR));) {
    n = read(ends[0], part, sizeof part);
    if (n > 0) out.text.append(part, static_cast<std::size_t>(n));
  }
  writer.join();
  close(ends[0]);
  while (child > 0 && waitpid(child, &out.status, 0) < 0 && errno == EINTR) continue;
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
  throw std::runtime_error("the command " + command + " needs the program " + path + ", which cannot be run: " + how);
}

void restart_without_blas_threads(char** argv) {
  rlimit addresses{};
  if (getrlimit(RLIMIT_AS, &addresses) != 0 || addresses.rlim_cur == RLIM_INFINITY) return;
  if (!std::getenv("OPENBLAS_NUM_THREADS") && setenv("OPENBLAS_NUM_THREADS", "1", 1) == 0)
    execv("/proc/self/exe", argv);  // if this fails, the process continues
}

}  // namespace manycontact::cli
