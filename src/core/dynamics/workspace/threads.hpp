#pragma once
// Threads inside one call on a scene's data, private to module dynamics.

#include "manycontact/kkt/costs.hpp"
#include "workspace.hpp"

namespace manycontact::internal {

/// Calls work(item, thread's memory) for items 0 ... count-1. Thread k mod (number of threads) has item k. Throws
/// what `work` throws.
template <class Work>
void each_item(Workspace& w, std::size_t count, Work&& work) {
  run_items(std::span<Failure>(w.failures), static_cast<std::ptrdiff_t>(count),
            [&](std::ptrdiff_t item, int thread) { work(static_cast<std::size_t>(item), w.threads[thread]); });
}

/// Calls the each_item above if `worth_threads`; else runs all items in the calling thread, with their threads' memory.
template <class Work>
void each_item(Workspace& w, std::size_t count, bool worth_threads, Work&& work) {
  if (worth_threads) return each_item(w, count, work);
  for (std::size_t k = 0; k < count; ++k) work(k, w.threads[k % w.threads.size()]);
}

/// Whether the predicted work [s] is large enough to wake the threads.
inline bool are_worth_threads(const Workspace& w, double seconds) {
  return seconds >= w.worth_a_thread * static_cast<double>(w.threads.size());
}
/// Calls work(island, number of the island, workspace of the thread) for each island that is not `done`. Islands for
/// which with_all_threads(island) is true come first, one by one, as each uses all threads.
template <class Done, class WithAllThreads, class Work>
void each_island(Workspace& w, Done&& done, WithAllThreads&& with_all_threads, Work&& work) {
  w.done.assign(w.islands.size(), 0);  // a copy, as `work` may change these conditions
  for (std::size_t i = 0; i < w.islands.size(); ++i)
    if (with_all_threads(*w.islands[i])) {
      work(*w.islands[i], i, w.threads.front());
      w.done[i] = 1;
    }
  std::size_t left = 0;
  for (std::size_t i = 0; i < w.islands.size(); ++i) {
    if (!w.done[i]) w.done[i] = done(*w.islands[i]);
    left += !w.done[i];
  }
  each_item(w, w.islands.size(), left > 1, [&](std::size_t i, ThreadWork& thread) {
    if (!w.done[i]) work(*w.islands[i], i, thread);
  });
}

}  // namespace manycontact::internal
