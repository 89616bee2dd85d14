#pragma once
// `manycontact batch`, in one process or in several.

#include <cstdint>
#include <exception>

#include "../command/arguments.hpp"

namespace manycontact::cli {

/// Communication between the processes of a run (mpi_main.cpp overrides it). All processes must make equal calls.
class Communicator {
 public:
  virtual ~Communicator() = default;
  virtual int rank() const { return 0; }
  virtual int size() const { return 1; }

  /// Waits for all processes. If some have errors, the first such process throws its error; others end silently.
  virtual void agree(std::exception_ptr error) {
    if (error) std::rethrow_exception(error);
  }
  /// After this call, until the end of the run, an error of one process ends all processes.
  virtual void begin() {}
  virtual void end() {}

  /// Distributes the value of rank 0 to all.
  virtual std::string told(const std::string& text) { return text; }
  /// Sums over all processes; every process gets the sums.
  virtual void sum(std::vector<std::int64_t>& numbers) { (void)numbers; }
  /// collect: rank 0 gets each number from the only process where it is not zero. largest: rank 0 gets the maxima.
  virtual void collect(double* numbers, std::int64_t count) { (void)numbers, (void)count; }
  virtual void largest(std::vector<int>& numbers) { (void)numbers; }
};

/// Runs the command as one process of the communicator. Returns the exit status.
int run_batch(const Arguments& arguments, Communicator& communicator);

/// Whether this process is one of several that mpirun started.
bool under_mpirun();

}  // namespace manycontact::cli
