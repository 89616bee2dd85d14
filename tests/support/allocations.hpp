#pragma once
// Counts heap allocations: Eigen and SuiteSparse call malloc, not operator new. A test executable that uses this has
// its malloc replaced (allocations.cpp).

#include <cstddef>

#if defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define MANYCONTACT_COUNTS_ALLOCATIONS 1
#else
#define MANYCONTACT_COUNTS_ALLOCATIONS 0
#endif

namespace manycontact::test {

/// Of the whole program, since its start.
std::size_t allocation_count();

/// Allocations while `work` runs.
template <class Work>
std::size_t allocations(Work&& work) {
  const std::size_t before = allocation_count();
  work();
  return allocation_count() - before;
}

}  // namespace manycontact::test
