#include "support/allocations.hpp"

#include <atomic>

#if MANYCONTACT_FAILS_ALLOCATIONS

// These functions, and those they call, run before sanitizers are set up, so they must not be instrumented.
#define PLAIN __attribute__((no_sanitize("address", "undefined")))

namespace {

std::size_t allocated = 0;
std::ptrdiff_t held = 0;
constinit thread_local long until_failure = -1;  // successful allocations before a failure; -1: none fails
constinit thread_local bool fail_all_after = false, failed = false;

PLAIN bool allocation_fails() {
  __atomic_fetch_add(&allocated, 1, __ATOMIC_RELAXED);
  if (until_failure < 0) return false;
  if (until_failure > 0) {
    --until_failure;
    return false;
  }
  failed = true;
  if (!fail_all_after) until_failure = -1;
  return true;
}

PLAIN void* hold(void* p) {
  if (p) __atomic_fetch_add(&held, 1, __ATOMIC_RELAXED);
  return p;
}

}  // namespace

#if defined(__SANITIZE_ADDRESS__)
// tinyxml and the loader's list of a library's dependencies leak if memory runs out.
extern "C" const char* __lsan_default_suppressions();
extern "C" const char* __lsan_default_suppressions() { return "leak:TiXml\nleak:_dl_map_object_deps\n"; }
#define NEXT(function) __interceptor_##function
#else
#define NEXT(function) __libc_##function
#endif

extern "C" {
void* NEXT(malloc)(std::size_t);
void* NEXT(calloc)(std::size_t, std::size_t);
void* NEXT(realloc)(void*, std::size_t);
void* NEXT(memalign)(std::size_t, std::size_t);
void NEXT(free)(void*);

PLAIN void* malloc(std::size_t size) noexcept { return allocation_fails() ? nullptr : hold(NEXT(malloc)(size)); }
PLAIN void* calloc(std::size_t count, std::size_t size) noexcept {
  return allocation_fails() ? nullptr : hold(NEXT(calloc)(count, size));
}
PLAIN void* realloc(void* old, std::size_t size) noexcept {
  if (allocation_fails()) return nullptr;
  void* p = NEXT(realloc)(old, size);
  if (!old) hold(p);
  if (old && !p && size == 0) __atomic_fetch_sub(&held, 1, __ATOMIC_RELAXED);
  return p;
}
PLAIN void* aligned_alloc(std::size_t alignment, std::size_t size) noexcept {
  return allocation_fails() ? nullptr : hold(NEXT(memalign)(alignment, size));
}
PLAIN void* memalign(std::size_t alignment, std::size_t size) noexcept {
  __atomic_fetch_add(&allocated, 1, __ATOMIC_RELAXED);
  return hold(NEXT(memalign)(alignment, size));
}
PLAIN int posix_memalign(void** p, std::size_t alignment, std::size_t size) noexcept {
  void* got = memalign(alignment, size);
  if (!got) return 12;  // ENOMEM
  *p = got;
  return 0;
}
PLAIN void free(void* p) noexcept {
  if (p) __atomic_fetch_sub(&held, 1, __ATOMIC_RELAXED);
  NEXT(free)(p);
}
}  // extern "C"

#if defined(__SANITIZE_ADDRESS__)
// The sanitizer's operator new does not call malloc. Forwarding each call lets the sanitizer check the matching delete.
#include <dlfcn.h>

namespace {
template <class... A>
PLAIN void* pass_on(const char* name, bool throws, A... a) {
  if (allocation_fails()) {
    if (throws) throw std::bad_alloc();
    return nullptr;
  }
  return reinterpret_cast<void* (*)(A...)>(dlsym(RTLD_NEXT, name))(a...);
}
}  // namespace

using std::align_val_t, std::nothrow_t;
PLAIN void* operator new(std::size_t n) { return pass_on("_Znwm", true, n); }
PLAIN void* operator new[](std::size_t n) { return pass_on("_Znam", true, n); }
PLAIN void* operator new(std::size_t n, align_val_t a) { return pass_on("_ZnwmSt11align_val_t", true, n, a); }
PLAIN void* operator new[](std::size_t n, align_val_t a) { return pass_on("_ZnamSt11align_val_t", true, n, a); }
PLAIN void* operator new(std::size_t n, const nothrow_t& t) noexcept {
  return pass_on("_ZnwmRKSt9nothrow_t", false, n, &t);
}
PLAIN void* operator new[](std::size_t n, const nothrow_t& t) noexcept {
  return pass_on("_ZnamRKSt9nothrow_t", false, n, &t);
}
#endif

namespace manycontact::test {
std::size_t allocation_count() { return __atomic_load_n(&allocated, __ATOMIC_RELAXED); }
std::ptrdiff_t blocks_held() { return MANYCONTACT_COUNTS_ALLOCATIONS ? __atomic_load_n(&held, __ATOMIC_RELAXED) : 0; }

FailingAllocation::FailingAllocation(long k, bool all_after) {
  failed = false;
  fail_all_after = all_after;
  until_failure = k;
}
FailingAllocation::~FailingAllocation() { until_failure = -1; }
bool FailingAllocation::reached() const { return failed; }
}  // namespace manycontact::test

#else

namespace manycontact::test {
std::size_t allocation_count() { return 0; }
std::ptrdiff_t blocks_held() { return 0; }
FailingAllocation::FailingAllocation(long, bool) {}
FailingAllocation::~FailingAllocation() = default;
bool FailingAllocation::reached() const { return false; }
}  // namespace manycontact::test

#endif
