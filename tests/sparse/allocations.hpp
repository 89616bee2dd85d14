#pragma once
// Counts every heap allocation of the program: Eigen and SuiteSparse call malloc, not operator new. To be included by
// one file of a test executable, since it replaces malloc.

#include <cstddef>

#if defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__)
#define MANYCONTACT_COUNTS_ALLOCATIONS 1

namespace manycontact::test {
inline std::size_t allocation_count = 0;
}

extern "C" {
void* __libc_malloc(std::size_t);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void* __libc_memalign(std::size_t, std::size_t);

void* malloc(std::size_t size) noexcept {
  ++manycontact::test::allocation_count;
  return __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) noexcept {
  ++manycontact::test::allocation_count;
  return __libc_calloc(count, size);
}
void* realloc(void* old, std::size_t size) noexcept {
  ++manycontact::test::allocation_count;
  return __libc_realloc(old, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) noexcept {
  ++manycontact::test::allocation_count;
  return __libc_memalign(alignment, size);
}
}  // extern "C"

#else
#define MANYCONTACT_COUNTS_ALLOCATIONS 0
namespace manycontact::test {
inline std::size_t allocation_count = 0;
}
#endif

namespace manycontact::test {

/// Allocations while `work` runs.
template <class Work>
std::size_t allocations(Work&& work) {
  const std::size_t before = allocation_count;
  work();
  return allocation_count - before;
}

}  // namespace manycontact::test
