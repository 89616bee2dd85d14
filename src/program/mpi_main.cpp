// The program manycontact-mpi, which runs `manycontact batch` in several processes.

#include <mpi.h>

#include <algorithm>
#include <cstdlib>
#include <limits>

#include "batch/batch.hpp"
#include "command/command.hpp"
#include "manycontact/io/input_error.hpp"

namespace manycontact::cli {
namespace {

int status_of(const std::exception_ptr& error) {
  if (!error) return kExitOk;
  try {
    std::rethrow_exception(error);
  } catch (const UsageError&) {
    return kExitUsage;
  } catch (const InputError&) {
    return kExitUsage;
  } catch (...) {
    return kExitUnsound;
  }
}

class MpiCommunicator final : public Communicator {
 public:
  MpiCommunicator() {
    MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
    MPI_Comm_size(MPI_COMM_WORLD, &size_);
  }
  int rank() const override { return rank_; }
  int size() const override { return size_; }

  void agree(std::exception_ptr error) override {
    const int own = error ? rank_ : size_;
    int speaker = size_, status = status_of(error);
    MPI_Allreduce(&own, &speaker, 1, MPI_INT, MPI_MIN, MPI_COMM_WORLD);
    if (speaker == size_) return;
    MPI_Bcast(&status, 1, MPI_INT, speaker, MPI_COMM_WORLD);
    if (rank_ == speaker) std::rethrow_exception(error);
    MPI_Finalize();
    std::exit(status);
  }
  void begin() override { at_work_ = true; }
  void end() override {
    MPI_Barrier(MPI_COMM_WORLD);
    at_work_ = false;
  }

  std::string told(const std::string& text) override {
    int size = static_cast<int>(text.size());
    MPI_Bcast(&size, 1, MPI_INT, 0, MPI_COMM_WORLD);
    std::string out = text;
    out.resize(static_cast<std::size_t>(size));
    MPI_Bcast(out.data(), size, MPI_CHAR, 0, MPI_COMM_WORLD);
    return out;
  }
  void sum(std::vector<std::int64_t>& numbers) override {
    MPI_Allreduce(MPI_IN_PLACE, numbers.data(), static_cast<int>(numbers.size()), MPI_INT64_T, MPI_SUM, MPI_COMM_WORLD);
  }
  // Combines the numbers by bitwise OR, because a sum would turn -0 into 0.
  void collect(double* numbers, std::int64_t count) override {
    constexpr std::int64_t kMost = std::numeric_limits<int>::max();
    for (std::int64_t first = 0; first < count; first += kMost)
      reduce(numbers + first, static_cast<int>(std::min(kMost, count - first)), MPI_UINT64_T, MPI_BOR);
  }
  void largest(std::vector<int>& numbers) override {
    reduce(numbers.data(), static_cast<int>(numbers.size()), MPI_INT, MPI_MAX);
  }

  bool at_work() const { return at_work_; }

 private:
  void reduce(void* numbers, int count, MPI_Datatype type, MPI_Op op) const {
    MPI_Reduce(rank_ == 0 ? MPI_IN_PLACE : numbers, numbers, count, type, op, 0, MPI_COMM_WORLD);
  }
  int rank_ = 0, size_ = 1;
  bool at_work_ = false;
};

MpiCommunicator* communicator = nullptr;

}  // namespace
}  // namespace manycontact::cli

int main(int argc, char** argv) {
  using namespace manycontact::cli;
  MPI_Init(&argc, &argv);
  MpiCommunicator all;
  communicator = &all;
  const auto run = [](const Arguments& arguments) { return run_batch(arguments, *communicator); };
  const int status = run_program({command("batch", run)}, {argv + (argc > 0), argv + argc});
  if (all.at_work()) MPI_Abort(MPI_COMM_WORLD, status);  // the other processes may wait for this one
  MPI_Finalize();
  return status;
}
