#pragma once
// The walk through the batches of an island's robots.

#include "../../workspace/threads.hpp"
#include "robots.hpp"

namespace manycontact::internal {

/// step(kernel, robots, their memory, memory of the thread) for each batch, each thread's one way and the next time
/// back: the last ones are still in the cache then. A batch is always the same thread's, whose kernel knows it.
/// of_solve: the work of all steps that this one belongs to, relative to that of a solve.
template <class Step>
void each_batch(Workspace& w, RobotsSystem& system, double of_solve, Step&& step) {
  system.back = !system.back;
  const std::size_t count = system.batches.size(), threads = w.threads.size();
  const auto item = [&](std::size_t k) -> const RobotsSystem::Batch& {
    const std::size_t first = k % threads, last = first + (count - 1 - first) / threads * threads;
    return system.batches[system.back ? last - (k - first) : k];
  };
  each_item(w, count, are_worth_threads(w, of_solve * system.seconds), [&](std::size_t k, ThreadWork& thread) {
    const RobotsSystem::Batch& batch = item(k);
    const std::size_t next = k + threads;  // next item of the same thread
    double* memory = system.memory.data();
    const std::span<RobotsSystem::Robot> robots = std::span(system.members).subspan(batch.first, batch.count);
    const lanes::RobotBlocks::Memory at{memory + batch.at, memory + (next < count ? item(next) : batch).at};
    step(batch.group->kernels[thread.number].of(robots.size()), robots, at, thread);
  });
}

template <class Step>
void each_batch(Workspace& w, RobotsSystem& system, Step&& step) {
  each_batch(w, system, costs::kWalk, std::forward<Step>(step));
}

}  // namespace manycontact::internal
