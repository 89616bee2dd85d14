#pragma once
// The one place that knows OpenMP, for loops over things that do not depend on each other.

#include <cstddef>

namespace manycontact::internal {

/// OpenMP's number of threads; 1 where the library was built without.
int default_threads();

/// work(context, item, thread) for each item of 0 ... count-1; thread k of at most `threads` has items k, k + threads,
/// ..., so that the same items meet the same memory in every call. Loops of OpenMP's inside (CHOLMOD's) stay in one
/// thread. `work` must not throw.
void run_items(int threads, std::ptrdiff_t count, void (*work)(void*, std::ptrdiff_t, int), void* context);

/// The same with anything that can be called as work(item, thread).
template <class Work>
void run_items(int threads, std::ptrdiff_t count, Work& work) {
  run_items(
      threads, count,
      [](void* context, std::ptrdiff_t item, int thread) { (*static_cast<Work*>(context))(item, thread); }, &work);
}

}  // namespace manycontact::internal
