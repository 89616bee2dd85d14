#include "peaks.hpp"

#ifdef __x86_64__
#include <immintrin.h>
#endif

#include <algorithm>
#include <ctime>
#include <vector>

namespace manycontact::bench {

namespace {

template <class Run>
double least_time(int rounds, Run&& run) {
  double least = 1e9;
  for (int k = 0; k < rounds; ++k) {
    const double start = processor_time();
    run();
    least = std::min(least, processor_time() - start);
  }
  return least;
}

constexpr int kChains = 12;  // independent sums: more than latency times units
constexpr long kTurns = 500000;
volatile double sink;

// kChains sums use fused multiply-adds, kTurns times. The empty assembly prevents the compiler from shortening them,
// and names instead of an array keep them in registers.
#ifdef __x86_64__
#define MANYCONTACT_EACH(do) \
  do (0) do(1) do(2) do(3) do(4) do(5) do(6) do(7) do(8) do(9) do(10) do(11)
#define MANYCONTACT_SUMS(name, level, Vector, broadcast, constraint) \
  __attribute__((target(level))) double name() {                     \
    const Vector x = broadcast(0.5), y = broadcast(1e-9);            \
    MANYCONTACT_EACH(MANYCONTACT_BEGIN##constraint)                  \
    for (long turn = 0; turn < kTurns; ++turn) {                     \
      MANYCONTACT_EACH(MANYCONTACT_ADD##constraint)                  \
    }                                                                \
    Vector all = y;                                                  \
    MANYCONTACT_EACH(MANYCONTACT_END##constraint)                    \
    return all[0];                                                   \
  }
#define MANYCONTACT_BEGINx(k) __m256d s##k = y;
#define MANYCONTACT_ADDx(k)           \
  s##k = _mm256_fmadd_pd(s##k, x, y); \
  asm volatile("" : "+x"(s##k));
#define MANYCONTACT_ENDx(k) all = _mm256_add_pd(all, s##k);
#define MANYCONTACT_BEGINv(k) __m512d s##k = y;
#define MANYCONTACT_ADDv(k)           \
  s##k = _mm512_fmadd_pd(s##k, x, y); \
  asm volatile("" : "+v"(s##k));
#define MANYCONTACT_ENDv(k) all = _mm512_add_pd(all, s##k);
MANYCONTACT_SUMS(sums_avx2, "avx2,fma", __m256d, _mm256_set1_pd, x)
MANYCONTACT_SUMS(sums_avx512, "avx512f", __m512d, _mm512_set1_pd, v)
#endif

double memory_rate() {
  const std::size_t n = std::size_t{16} << 20;  // doubles: three arrays of 128 MB
  std::vector<double> a(n, 1), b(n, 2), c(n, 3);
  const double time = least_time(5, [&] {
    for (std::size_t k = 0; k < n; ++k) a[k] = b[k] + 0.5 * c[k];
    sink = a[n / 2];
  });
  return 3.0 * 8 * static_cast<double>(n) / time;  // reads of `a` before it is written are not counted
}

}  // namespace

double processor_time() {
  timespec now;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

Peaks measure_peaks() {
  Peaks out;
  int width = 1;
  double (*sums)() = nullptr;
#ifdef __x86_64__
  if (__builtin_cpu_supports("avx512f"))
    out.instructions = "AVX-512", width = 8, sums = sums_avx512;
  else if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"))
    out.instructions = "AVX2", width = 4, sums = sums_avx2;
#endif
  if (sums) out.flops = 2.0 * width * kChains * kTurns / least_time(21, [&] { sink = sums(); });
  out.memory = memory_rate();
  return out;
}

}  // namespace manycontact::bench
