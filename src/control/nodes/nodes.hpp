#pragma once
// Loops over nodes, which do not depend on each other.

#include <exception>
#include <mutex>

#include "../../dynamics/parallel.hpp"

namespace manycontact::internal {

/// work(t) for t = 0 ... count - 1, over at most `threads` threads. An exception of the first node that throws is
/// thrown again.
template <class Work>
void each_node(std::size_t threads, std::size_t count, Work&& work) {
  if (threads <= 1) {
    for (std::size_t t = 0; t < count; ++t) work(t);
    return;
  }
  std::exception_ptr thrown;
  std::ptrdiff_t first = static_cast<std::ptrdiff_t>(count);
  std::mutex mutex;
  auto guarded = [&](std::ptrdiff_t t, int) {
    try {
      work(static_cast<std::size_t>(t));
    } catch (...) {
      const std::lock_guard lock(mutex);
      if (t < first) {
        first = t;
        thrown = std::current_exception();
      }
    }
  };
  run_items(static_cast<int>(threads), static_cast<std::ptrdiff_t>(count), guarded);
  if (thrown) std::rethrow_exception(thrown);
}

}  // namespace manycontact::internal
