#pragma once
// Ctrl-C and `kill`: commands with an InterruptFlag keep their results so far, and no temporary file remains.

#include <string>

namespace manycontact::cli {

/// After this call SIGINT, SIGTERM and SIGHUP, unless ignored, remove the temporary files and end the program.
void hear_signals();

/// During its lifetime, the first SIGINT, SIGTERM or SIGHUP sets a flag, and the second signal ends the program.
class InterruptFlag {
 public:
  InterruptFlag();
  ~InterruptFlag();
  InterruptFlag(const InterruptFlag&) = delete;
  InterruptFlag& operator=(const InterruptFlag&) = delete;
  bool is_set() const;
};

/// During its lifetime, a signal that ends the program removes the file `path`.
class RemovedBySignals {
 public:
  explicit RemovedBySignals(const std::string& path);
  ~RemovedBySignals();
  RemovedBySignals(const RemovedBySignals&) = delete;
  RemovedBySignals& operator=(const RemovedBySignals&) = delete;

 private:
  int slot_;
};

}  // namespace manycontact::cli
