#pragma once
// The processes of one run and their communication. All of them make the same calls in the same order.

#include <cstdint>
#include <exception>
#include <string>
#include <vector>

namespace manycontact::cli {

/// One process, which has nobody to talk to. With MPI: mpi_main.cpp.
class Communicator {
 public:
  virtual ~Communicator() = default;
  virtual int rank() const { return 0; }
  virtual int size() const { return 1; }

  /// Waits for all. Where one met an error, the first of these throws it, and the others end without a word.
  virtual void agree(std::exception_ptr error) {
    if (error) std::rethrow_exception(error);
  }
  /// From here to the end of the run, an error of one ends all.
  virtual void begin() {}
  virtual void end() {}

  /// Distributes the value of rank 0 to all.
  virtual std::string told(const std::string& text) { return text; }
  /// Sums over all processes, known to all.
  virtual void sum(std::vector<std::int64_t>& numbers) { (void)numbers; }
  /// At rank 0: numbers that one process has and that are zero elsewhere; the largest of each entry.
  virtual void collect(double* numbers, std::int64_t count) { (void)numbers, (void)count; }
  virtual void largest(std::vector<int>& numbers) { (void)numbers; }
};

}  // namespace manycontact::cli
