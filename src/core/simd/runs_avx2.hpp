// Whether this processor has the instructions of the level avx2: those of -mavx2 -mfma. The build asks, too.
#pragma once
namespace manycontact::simd {
inline bool runs_avx2() {
  __builtin_cpu_init();
  return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
}
}  // namespace manycontact::simd
