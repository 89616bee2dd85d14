#pragma once
// Handles Ctrl-C and `kill`. Commands with an InterruptFlag keep their results so far, and no temporary file remains.

#include <string>

namespace manycontact::cli {

/// After this call SIGINT, SIGTERM and SIGHUP, unless they are ignored, remove temporary files and end the program.
void hear_signals();

/// Makes the first SIGINT, SIGTERM or SIGHUP during its lifetime set a flag. A second signal ends the program.
class InterruptFlag {
 public:
  InterruptFlag();
  ~InterruptFlag();
  InterruptFlag(const InterruptFlag&) = delete;
  InterruptFlag& operator=(const InterruptFlag&) = delete;
  bool is_set() const;
};

class RemovedBySignals {  // makes a signal that ends the program during its lifetime remove the file `path`
 public:
  explicit RemovedBySignals(const std::string& path);
  ~RemovedBySignals();
  RemovedBySignals(const RemovedBySignals&) = delete;
  RemovedBySignals& operator=(const RemovedBySignals&) = delete;

 private:
  int slot_;
};

}  // namespace manycontact::cli
