#pragma once
// Threads inside one call on a scene's data, private to module dynamics.

#include "manycontact/kkt/costs.hpp"
#include "workspace.hpp"

namespace manycontact::internal {

/// Calls work(item, thread's memory) for items 0 ... count-1; thread k modulo their number has item k. Throws as
/// run_items.
template <class Work>
void each_item(Workspace& w, std::size_t count, Work&& work) {
  run_items(std::span<Failure>(w.failures), static_cast<std::ptrdiff_t>(count),
            [&](std::ptrdiff_t item, int thread) { work(static_cast<std::size_t>(item), w.threads[thread]); });
}

/// Does the same, in the calling thread if not `worth_threads`, but with the memory of each item's own thread.
template <class Work>
void each_item(Workspace& w, std::size_t count, bool worth_threads, Work&& work) {
  if (worth_threads) return each_item(w, count, work);
  for (std::size_t k = 0; k < count; ++k) work(k, w.threads[k % w.threads.size()]);
}

/// Whether so much predicted work [s] is worth waking the threads of these data.
inline bool are_worth_threads(const Workspace& w, double seconds) {
  return seconds >= w.worth_a_thread * static_cast<double>(w.threads.size());
}
/// Calls work(island, its number, workspace of the thread) for each island that is not `done`. Islands with
/// with_all_threads(island) come first, one by one, as each uses all threads.
template <class Done, class WithAllThreads, class Work>
void each_island(Workspace& w, Done&& done, WithAllThreads&& with_all_threads, Work&& work) {
  w.done.assign(w.islands.size(), 0);  // work may change these conditions
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
