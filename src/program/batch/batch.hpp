#pragma once
// The command `manycontact batch`, in one process or in several.

#include <cstdint>
#include <exception>

#include "../command/arguments.hpp"

namespace manycontact::cli {

/// Communication between the processes of a run, which mpi_main.cpp overrides. All processes must make the same calls.
class Communicator {
 public:
  virtual ~Communicator() = default;
  virtual int rank() const { return 0; }
  virtual int size() const { return 1; }

  /// Waits for all processes. If some have errors, the first of them throws its error, and the others end silently.
  virtual void agree(std::exception_ptr error) {
    if (error) std::rethrow_exception(error);
  }
  /// From this call to `end`, an error of one process ends all processes.
  virtual void begin() {}
  virtual void end() {}

  virtual std::string told(const std::string& text) { return text; }
  /// Replaces the numbers by their sums over all processes, in every process.
  virtual void sum(std::vector<std::int64_t>& numbers) { (void)numbers; }
  /// collect gives rank 0 each number, which only one process has and the others set to zero. largest gives rank 0 the
  /// maximum of each number over all processes.
  virtual void collect(double* numbers, std::int64_t count) { (void)numbers, (void)count; }
  virtual void largest(std::vector<int>& numbers) { (void)numbers; }
};

/// Runs the command as one process of the communicator. Returns the exit status.
int run_batch(const Arguments& arguments, Communicator& communicator);

bool under_mpirun();  // returns whether this process is one of several that mpirun started

}  // namespace manycontact::cli
