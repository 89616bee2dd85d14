#pragma once
// The walk through the batches of an island's robots.

#include "../../threads.hpp"
#include "robots.hpp"

namespace manycontact::internal {

/// step(kernel, robots, their memory, memory of the thread) for each batch, one way and the next time back: the last
/// ones are still in the cache then.
template <class Step>
void each_batch(Workspace& w, RobotsSystem& system, Step&& step) {
  system.back = !system.back;
  const std::size_t count = system.batches.size();
  const auto item = [&](std::size_t k) -> const RobotsSystem::Batch& {
    return system.batches[system.back ? count - 1 - k : k];
  };
  each_item(w, count, [&](std::size_t k, ThreadWork& thread) {
    const RobotsSystem::Batch& batch = item(k);
    const std::size_t next = k + w.threads.size();  // of the same thread
    double* memory = system.memory.data();
    step(*batch.group->kernels[thread.number], std::span(system.members).subspan(batch.first, batch.count),
         lanes::RobotBlocks::Memory{memory + batch.at, memory + (next < count ? item(next) : batch).at}, thread);
  });
}

}  // namespace manycontact::internal
