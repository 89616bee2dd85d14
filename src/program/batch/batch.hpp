#pragma once
// `manycontact batch`, in one process or in several.

#include <cstdint>
#include <exception>

#include "../command/arguments.hpp"

namespace manycontact::cli {

// The processes of one run and their communication. All of them make the same calls in the same order.

/// One process, which has nobody to talk to. With MPI: mpi_main.cpp.
class Communicator {
 public:
  virtual ~Communicator() = default;
  virtual int rank() const { return 0; }
  virtual int size() const { return 1; }

  /// Waits for all. If processes met errors, the first one throws its error, and the others end without a message.
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
  /// collect: rank 0 gets numbers that one process has and that are zero elsewhere. largest: the largest of each entry.
  virtual void collect(double* numbers, std::int64_t count) { (void)numbers, (void)count; }
  virtual void largest(std::vector<int>& numbers) { (void)numbers; }
};

/// The command, as a member of that communicator. Returns the exit status.
int run_batch(const Arguments& arguments, Communicator& communicator);

/// Whether this process is one of several that mpirun started.
bool under_mpirun();

}  // namespace manycontact::cli
