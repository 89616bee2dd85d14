#pragma once

#include <chrono>
#include <exception>
#include <mutex>

#include "manycontact/control/shooting.hpp"
#include "manycontact/dynamics/parallel.hpp"

namespace manycontact::internal {

/// Calls work(t, thread) for t = 0 ... count - 1 on at most `threads` threads, where thread 0 is the caller's. If calls
/// throw, rethrows the exception of the smallest t.
template <class Work>
void each_node_by_thread(std::size_t threads, std::size_t count, Work&& work) {
  if (threads <= 1) {
    for (std::size_t t = 0; t < count; ++t) work(t, 0);
    return;
  }
  std::exception_ptr thrown;
  std::ptrdiff_t first = static_cast<std::ptrdiff_t>(count);
  std::mutex mutex;
  auto guarded = [&](std::ptrdiff_t t, int thread) {
    try {
      work(static_cast<std::size_t>(t), thread);
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

/// Calls work(t) for t = 0 ... count - 1 on at most `threads` threads.
template <class Work>
void each_node(std::size_t threads, std::size_t count, Work&& work) {
  each_node_by_thread(threads, count, [&](std::size_t t, int) { work(t); });
}

/// Calls work(t) on one thread if the last loop took less than kWorthAThread per thread, otherwise on all `threads`.
template <class Work>
void each_node(std::size_t threads, std::size_t count, LoopTime& last, Work&& work) {
  constexpr double kWorthAThread = 5e-5;  // least work per thread [s], which exceeds the time to wake a thread
  using Clock = std::chrono::steady_clock;
  if (threads <= 1) return each_node(1, count, work);
  const std::size_t used = last.seconds < kWorthAThread * static_cast<double>(threads) ? 1 : threads;
  Clock::time_point begin;  // start of the calling thread's nodes, so that waiting for other threads is not measured
  each_node_by_thread(used, count, [&](std::size_t t, int thread) {
    if (t == 0) begin = Clock::now();
    work(t);
    if (thread == 0 && t + used >= count)
      last.seconds = std::chrono::duration<double>(Clock::now() - begin).count() * static_cast<double>(used);
  });
}

}  // namespace manycontact::internal
