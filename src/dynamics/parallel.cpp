// Compiled with OpenMP where there is one, and alone: Eigen compiled so would start threads of its own.

#include "parallel.hpp"

#ifdef _OPENMP
#include <omp.h>
#endif

namespace manycontact::internal {

#ifdef _OPENMP

int default_threads() { return omp_get_max_threads(); }

void run_items(int threads, std::ptrdiff_t count, void (*work)(void*, std::ptrdiff_t, int), void* context) {
  const int levels = omp_get_max_active_levels();
  omp_set_max_active_levels(omp_get_active_level() + (threads > 1 ? 1 : 0));
#pragma omp parallel for num_threads(threads) schedule(static, 1)
  for (std::ptrdiff_t item = 0; item < count; ++item) work(context, item, omp_get_thread_num());
  omp_set_max_active_levels(levels);
}

#else

int default_threads() { return 1; }

void run_items(int, std::ptrdiff_t count, void (*work)(void*, std::ptrdiff_t, int), void* context) {
  for (std::ptrdiff_t item = 0; item < count; ++item) work(context, item, 0);
}

#endif

}  // namespace manycontact::internal
