#include "simd/levels.hpp"

namespace manycontact {

namespace sparse {
extern const PanelKernels level_baseline, level_avx2, level_avx512;
}
namespace lq {
extern const DenseKernels level_baseline, level_avx2;
}
namespace lanes {
extern const Level level_baseline, level_avx2, level_avx512;
}

namespace simd {

namespace {

#ifdef MANYCONTACT_LEVEL_avx2
// -mavx2 -mfma
bool runs_avx2() { return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"); }
#endif

#ifdef MANYCONTACT_LEVEL_avx512
// -mavx512f -mavx512dq -mavx512vl -mavx512bw -mavx512cd -mavx2 -mfma
bool runs_avx512() {
  return runs_avx2() && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
         __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512cd");
}
#endif

// Each level runs wherever the one before does. AVX-512 gains nothing over AVX2 in Eigen's products of dense blocks.
constexpr Level kLevels[] = {
#ifdef MANYCONTACT_LEVEL_avx512
    {"avx512", sparse::level_avx512, lq::level_avx2, lanes::level_avx512},
#endif
#ifdef MANYCONTACT_LEVEL_avx2
    {"avx2", sparse::level_avx2, lq::level_avx2, lanes::level_avx2},
#endif
    {"baseline", sparse::level_baseline, lq::level_baseline, lanes::level_baseline},
};

std::span<const Level> levels_here() {
  std::span<const Level> all(kLevels);
#ifdef MANYCONTACT_LEVEL_avx2
  __builtin_cpu_init();
#ifdef MANYCONTACT_LEVEL_avx512
  if (!runs_avx512()) all = all.subspan(1);
#endif
  if (!runs_avx2()) all = all.subspan(1);
#endif
  return all;
}

}  // namespace

std::span<const Level> levels() {
  static const std::span<const Level> here = levels_here();
  return here;
}

}  // namespace simd
}  // namespace manycontact
