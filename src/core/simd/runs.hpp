// Functions that return whether this processor supports a level's instructions (lane_flags_LEVEL in levels.cmake).
#pragma once
#if defined(__x86_64__)
namespace manycontact::simd {
inline bool runs_avx2() {
  __builtin_cpu_init();
  return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
}
inline bool runs_avx512() {
  return runs_avx2() && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
         __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512cd");
}
}  // namespace manycontact::simd
#endif
