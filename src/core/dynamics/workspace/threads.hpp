#pragma once
// Threads inside one call on a scene's data, private to module dynamics.

#include "manycontact/kkt/costs.hpp"
#include "workspace.hpp"

namespace manycontact::internal {

/// Calls work(k, thread's memory) for k < count, in thread k mod (number of threads). Throws what `work` throws.
template <class Work>
void each_item(Workspace& w, std::size_t count, Work&& work) {
  run_items(std::span<Failure>(w.failures), static_cast<std::ptrdiff_t>(count),
            [&](std::ptrdiff_t item, int thread) { work(static_cast<std::size_t>(item), w.threads[thread]); });
}

/// Calls the function above if `worth_threads`; else runs all items in this thread, each with the memory it has above.
template <class Work>
void each_item(Workspace& w, std::size_t count, bool worth_threads, Work&& work) {
  if (worth_threads) return each_item(w, count, work);
  for (std::size_t k = 0; k < count; ++k) work(k, w.threads[k % w.threads.size()]);
}

inline bool are_worth_threads(const Workspace& w, double seconds) {  // whether `seconds` of work justify waking threads
  return seconds >= w.worth_a_thread * static_cast<double>(w.threads.size());
}
/// Calls work(island, number of the island, thread's memory), first for islands with with_all_threads(island), one by
/// one, as each uses all threads. The other islands for which done(island) is false follow in parallel.
template <class Done, class WithAllThreads, class Work>
void each_island(Workspace& w, Done&& done, WithAllThreads&& with_all_threads, Work&& work) {
  w.done.assign(w.islands.size(), 0);  // stored, as `work` may change the results of done(island)
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
