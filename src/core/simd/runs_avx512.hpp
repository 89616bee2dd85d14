// Whether this processor has the instructions of the level avx512, which are those of lane_flags_avx512 in
// levels.cmake.
#pragma once
namespace manycontact::simd {
inline bool runs_avx512() {
  __builtin_cpu_init();
  return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") && __builtin_cpu_supports("avx512f") &&
         __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl") &&
         __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512cd");
}
}  // namespace manycontact::simd
