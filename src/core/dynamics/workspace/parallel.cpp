// The only source compiled with OpenMP (if available): Eigen compiled with OpenMP would start its own threads.

#include "manycontact/dynamics/parallel.hpp"

#ifdef _OPENMP
#include <omp.h>
#endif
#if defined(_OPENMP) && __has_include(<pthread.h>)
#include <pthread.h>
#endif
#ifdef __SANITIZE_THREAD__
#include <sanitizer/tsan_interface.h>
#endif

namespace manycontact::internal {

#ifdef _OPENMP

int default_threads() { return omp_get_max_threads(); }

#if __has_include(<pthread.h>)
// Releases libgomp's threads before a fork, as the child process would wait forever for threads that it does not have.
const int given_back_before_fork = pthread_atfork([] { omp_pause_resource_all(omp_pause_soft); }, nullptr, nullptr);
#endif

// The thread sanitizer does not see libgomp's barriers, so these macros declare them.
#ifdef __SANITIZE_THREAD__
#define BEFORE(place) __tsan_release(place)
#define AFTER(place) __tsan_acquire(place)
__attribute__((no_sanitize("thread")))
#else
#define BEFORE(place) (void)(place)
#define AFTER(place) (void)(place)
#endif
void run_items(int threads, std::ptrdiff_t count, void (*work)(void*, std::ptrdiff_t, int), void* context) {
  const int levels = omp_get_max_active_levels();
  omp_set_max_active_levels(omp_get_active_level() + (threads > 1 ? 1 : 0));
  BEFORE(context);
#pragma omp parallel num_threads(threads)
  {
    AFTER(context);
#pragma omp for schedule(static, 1) nowait
    for (std::ptrdiff_t item = 0; item < count; ++item) work(context, item, omp_get_thread_num());
    BEFORE(context);
  }
  AFTER(context);
  omp_set_max_active_levels(levels);
}

#else

int default_threads() { return 1; }

void run_items(int, std::ptrdiff_t count, void (*work)(void*, std::ptrdiff_t, int), void* context) {
  for (std::ptrdiff_t item = 0; item < count; ++item) work(context, item, 0);
}

#endif

}  // namespace manycontact::internal
