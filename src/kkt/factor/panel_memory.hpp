#pragma once

#include <cstddef>
#include <vector>

namespace manycontact::internal {

/// Memory of panels, of `size` doubles, which the factors of a thread share: it stays in the cache.
inline double* panel_memory(std::size_t size) {
  thread_local std::vector<double> memory;
  if (memory.size() < size) memory.resize(size);
  return memory.data();
}

}  // namespace manycontact::internal
