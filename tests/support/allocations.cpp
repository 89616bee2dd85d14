#include "support/allocations.hpp"

#include <atomic>

namespace manycontact::test {
namespace {
std::atomic<std::size_t> count = 0;
}
std::size_t allocation_count() { return count; }
}  // namespace manycontact::test

#if MANYCONTACT_COUNTS_ALLOCATIONS
extern "C" {
void* __libc_malloc(std::size_t);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void* __libc_memalign(std::size_t, std::size_t);

void* malloc(std::size_t size) noexcept {
  ++manycontact::test::count;
  return __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) noexcept {
  ++manycontact::test::count;
  return __libc_calloc(count, size);
}
void* realloc(void* old, std::size_t size) noexcept {
  ++manycontact::test::count;
  return __libc_realloc(old, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) noexcept {
  ++manycontact::test::count;
  return __libc_memalign(alignment, size);
}
}  // extern "C"
#endif
