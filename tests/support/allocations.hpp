#pragma once
// Counts heap allocations, and makes them fail. Eigen and SuiteSparse call malloc, not operator new, so a test
// executable that uses this has its malloc replaced (allocations.cpp), for the shared libraries it loads too.
//
//   EXPECT_EQ(allocations([&] { solve(...); }), 0u);
//
//   // The 0th, 1st, 2nd ... allocation in the first braces fails, until one run requests no more.
//   const FailedRuns runs = fail_each_allocation([&] { load(...); }, [&] { EXPECT_TRUE(still_sound()); });
//   EXPECT_GT(runs.failed, 0);

#include <gtest/gtest.h>

#include <cstddef>
#include <exception>
#include <new>
#include <string>

#if defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define MANYCONTACT_COUNTS_ALLOCATIONS 1
#else
#define MANYCONTACT_COUNTS_ALLOCATIONS 0
#endif

// Under AddressSanitizer allocations fail too; it also finds leaks.
#if defined(__GLIBC__) && !defined(__SANITIZE_THREAD__)
#define MANYCONTACT_FAILS_ALLOCATIONS 1
#else
#define MANYCONTACT_FAILS_ALLOCATIONS 0
#endif

namespace manycontact::test {

/// Returns the number of allocations of the whole program since its start.
std::size_t allocation_count();
/// Returns allocated blocks that are not freed if allocations are counted, otherwise 0.
std::ptrdiff_t blocks_held();

/// Returns the number of allocations while `work` runs.
template <class Work>
std::size_t allocations(Work&& work) {
  const std::size_t before = allocation_count();
  work();
  return allocation_count() - before;
}

/// During its lifetime this thread's k-th allocation (from 0) fails, with `all_after` the later ones too. malloc
/// returns null, new throws.
class FailingAllocation {
 public:
  FailingAllocation(long k, bool all_after);
  ~FailingAllocation();
  FailingAllocation(const FailingAllocation&) = delete;
  FailingAllocation& operator=(const FailingAllocation&) = delete;
  /// Whether the k-th allocation was requested.
  bool reached() const;
};

struct FailedRuns {
  long failed = 0;    // runs in which an allocation failed
  long survived = 0;  // number of these that ended without an exception
};

/// Runs work() repeatedly with its k-th allocation failing, k = 0, 1, 2, ..., each k alone and then with all later
/// ones. Such a run must end with std::bad_alloc or normally; after each, check() is called with memory as usual. If
/// `keeps_memory` is false, work must release all it allocates.
template <class Work, class Check>
FailedRuns fail_each_allocation(Work&& work, Check&& check, bool keeps_memory = false) {
  FailedRuns runs;
  for (bool reached = true; reached;) {
    reached = false;
    for (const bool all_after : {false, true}) {
      bool threw = false, another = false;
      const std::ptrdiff_t before = blocks_held();
      try {
        const FailingAllocation failing(runs.failed / 2, all_after);
        try {
          work();
        } catch (...) {
          reached = failing.reached();
          throw;
        }
        reached = failing.reached();
      } catch (const std::bad_alloc&) {
        threw = true;
      } catch (...) {
        another = true;
      }
      const std::ptrdiff_t kept = blocks_held() - before;
      const auto which = testing::Message() << "allocation " << runs.failed / 2 << (all_after ? " and all after" : "");
      EXPECT_FALSE(another) << which << ": not std::bad_alloc";
      EXPECT_TRUE(reached || !threw) << which << ": none failed, yet std::bad_alloc";
      EXPECT_TRUE(keeps_memory || kept == 0) << which << ": " << kept << " blocks were leaked";
      const testing::ScopedTrace trace(__FILE__, __LINE__, which);
      check();
      if (!reached) return runs;
      ++runs.failed;
      runs.survived += !threw;
      if (testing::Test::HasFatalFailure()) return runs;
    }
  }
  return runs;
}

}  // namespace manycontact::test
