#pragma once
// Threads inside one call on a scene's data, private to floor dynamics.

#include <optional>

#include "manycontact/sparse/blas_threads.hpp"
#include "workspace.hpp"

namespace manycontact::internal {

/// work(item, memory of the thread) for each item of 0 ... count-1, by the threads of these data. Item k is that of
/// thread k modulo their number. Exceptions come out as run_items has them.
template <class Work>
void each_item(Workspace& w, std::size_t count, Work&& work) {
  run_items(std::span<Failure>(w.failures), static_cast<std::ptrdiff_t>(count), [&](std::ptrdiff_t item, int thread) {
    work(static_cast<std::size_t>(item), w.threads[static_cast<std::size_t>(thread)]);
  });
}

/// OpenBLAS in one thread, as long as it lives, where these data have several.
class OneBlasOfThreads {
 public:
  explicit OneBlasOfThreads(const Workspace& w) {
    if (w.threads.size() > 1) one_.emplace();
  }

 private:
  std::optional<sparse::OneBlasThread> one_;
};

}  // namespace manycontact::internal
