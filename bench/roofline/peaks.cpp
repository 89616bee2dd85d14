#include "peaks.hpp"

#include <algorithm>
#include <chrono>
#include <vector>

namespace manycontact::bench {

namespace {

using Clock = std::chrono::steady_clock;

template <class Run>
double least_time(int rounds, Run&& run) {
  double least = 1e9;
  for (int k = 0; k < rounds; ++k) {
    const Clock::time_point start = Clock::now();
    run();
    least = std::min(least, std::chrono::duration<double>(Clock::now() - start).count());
  }
  return least;
}

constexpr int kChains = 12;  // independent sums: more than latency times units
constexpr long kTurns = 2000000;
volatile double sink;

// kChains sums of `width` doubles, kTurns times.
#define MANYCONTACT_FMA(name, width, level)                                             \
  __attribute__((target(level))) double name() {                                        \
    typedef double Vector __attribute__((vector_size(8 * (width))));                    \
    Vector sums[kChains] = {}, x = Vector{} + 0.5, y = Vector{} + 1e-9;                 \
    for (long turn = 0; turn < kTurns; ++turn)                                          \
      for (int k = 0; k < kChains; ++k) {                                               \
        sums[k] = sums[k] * x + y;                                                      \
        asm volatile("" : "+x"(sums[k]));                                               \
      }                                                                                 \
    double all = 0;                                                                     \
    for (const Vector& sum : sums) all += sum[0];                                       \
    return all;                                                                         \
  }
#ifdef __x86_64__
#pragma GCC diagnostic ignored "-Wpsabi"
MANYCONTACT_FMA(sums_avx2, 4, "avx2,fma")
MANYCONTACT_FMA(sums_baseline, 2, "sse2")
#undef MANYCONTACT_FMA
// registers beyond xmm15 need another constraint
__attribute__((target("avx512f"))) double sums_avx512() {
  typedef double Vector __attribute__((vector_size(64)));
  Vector sums[kChains] = {}, x = Vector{} + 0.5, y = Vector{} + 1e-9;
  for (long turn = 0; turn < kTurns; ++turn)
    for (int k = 0; k < kChains; ++k) {
      sums[k] = sums[k] * x + y;
      asm volatile("" : "+v"(sums[k]));
    }
  double all = 0;
  for (const Vector& sum : sums) all += sum[0];
  return all;
}
#endif

double memory_rate() {
  const std::size_t n = std::size_t{16} << 20;  // doubles: three arrays of 128 MB
  std::vector<double> a(n, 1), b(n, 2), c(n, 3);
  const double time = least_time(5, [&] {
    for (std::size_t k = 0; k < n; ++k) a[k] = b[k] + 0.5 * c[k];
    sink = a[n / 2];
  });
  return 3.0 * 8 * static_cast<double>(n) / time;  // without what is read of `a` before it is written
}

}  // namespace

Peaks measure_peaks() {
  Peaks out;
  int width = 1;
  double (*sums)() = nullptr;
#ifdef __x86_64__
  if (__builtin_cpu_supports("avx512f"))
    out.instructions = "AVX-512", width = 8, sums = sums_avx512;
  else if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"))
    out.instructions = "AVX2", width = 4, sums = sums_avx2;
  else
    out.instructions = "SSE2", width = 2, sums = sums_baseline;
#endif
  if (sums) out.flops = 2.0 * width * kChains * kTurns / least_time(9, [&] { sink = sums(); });
  out.memory = memory_rate();
  return out;
}

}  // namespace manycontact::bench
