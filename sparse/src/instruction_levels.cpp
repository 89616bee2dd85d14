#include "manycontact/sparse/instruction_levels.hpp"

namespace manycontact::sparse {

#if defined(__x86_64__)

// -mavx2 -mfma
bool runs_avx2() {
  __builtin_cpu_init();
  return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
}

// -mavx512f -mavx512dq -mavx512vl -mavx512bw -mavx512cd -mavx2 -mfma
bool runs_avx512() {
  return runs_avx2() && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
         __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512cd");
}

#else

bool runs_avx2() { return false; }
bool runs_avx512() { return false; }

#endif

}  // namespace manycontact::sparse
