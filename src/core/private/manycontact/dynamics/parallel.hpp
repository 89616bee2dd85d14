#pragma once
// The only interface to OpenMP, for loops with independent items.

#include <atomic>
#include <cstddef>
#include <exception>
#include <span>

namespace manycontact::internal {

/// Returns OpenMP's number of threads, or 1 without OpenMP.
int default_threads();

/// Calls work(context, item, thread) for items 0 ... count-1. Thread k processes items k, k + threads, ..., so that in
/// every call the same thread processes an item. Nested OpenMP loops run in one thread. `work` must not throw.
void run_items(int threads, std::ptrdiff_t count, void (*work)(void*, std::ptrdiff_t, int), void* context);

/// Calls work(item, thread) for items 0 ... count-1 in parallel, for any callable `work` that does not throw.
template <class Work>
void run_items(int threads, std::ptrdiff_t count, Work& work) {
  run_items(
      threads, count,
      [](void* context, std::ptrdiff_t item, int thread) { (*static_cast<Work*>(context))(item, thread); }, &work);
}

/// The exception that ended a thread's work, and the item that threw it.
struct Failure {
  std::exception_ptr error;
  std::ptrdiff_t item = 0;
};

/// Calls work(item, thread), which may throw; `failures` has one entry per thread. After the first exception no further
/// item is started, and the exception of the lowest item is rethrown. The calling thread takes part in the work.
template <class Work>
void run_items(std::span<Failure> failures, std::ptrdiff_t count, Work&& work) {
  if (failures.size() <= 1 || count <= 1) {
    for (std::ptrdiff_t item = 0; item < count; ++item) work(item, 0);
    return;
  }
  for (Failure& failure : failures) failure.error = nullptr;
  std::atomic<bool> stop = false;
  auto guarded = [&](std::ptrdiff_t item, int thread) {
    if (stop) return;
    try {
      work(item, thread);
    } catch (...) {
      failures[static_cast<std::size_t>(thread)] = {std::current_exception(), item};
      stop = true;
    }
  };
  run_items(static_cast<int>(failures.size()), count, guarded);
  const Failure* first = nullptr;
  for (const Failure& failure : failures)
    if (failure.error && (!first || failure.item < first->item)) first = &failure;
  if (first) std::rethrow_exception(first->error);
}

}  // namespace manycontact::internal
