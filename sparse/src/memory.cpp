#include "manycontact/sparse/memory.hpp"

#include <unistd.h>

#include <cstdio>

namespace manycontact::sparse {

namespace {
double memory() {
  static const double bytes = static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGESIZE));
  return bytes;
}
}  // namespace

TooLarge::TooLarge(double bytes) {
  std::snprintf(text_, sizeof text_, "an island's system would take %.2g GB or more, this machine has %.2g GB",
                bytes / 1e9, memory() / 1e9);
}

void require_memory(double bytes) {
  if (bytes > memory()) throw TooLarge(bytes);
}

}  // namespace manycontact::sparse
