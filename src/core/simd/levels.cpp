#include "simd/levels.hpp"

#include <stdexcept>
#include <string>

#include "simd/runs.hpp"

namespace manycontact {

namespace sparse {
extern const PanelKernels level_baseline, level_avx2, level_avx512;
extern const DenseKernels blocks_level_baseline, blocks_level_avx2;
}  // namespace sparse
namespace lanes {
extern const Level level_baseline, level_avx2, level_avx512;
extern const Level level_one_baseline, level_one_avx2, level_one_avx512;
}  // namespace lanes
namespace extended {
extern const Level level_baseline, level_avx2;
}

namespace simd {

namespace {

// The levels of this build. A processor that supports a level also supports all levels after it. The avx512 level uses
// the dense products and the double-double arithmetic of avx2, which gain nothing from AVX-512.
constexpr Level kLevels[] = {
#ifdef MANYCONTACT_LEVEL_avx512
    {"avx512", sparse::level_avx512, sparse::blocks_level_avx2, lanes::level_avx512, lanes::level_one_avx512,
     extended::level_avx2, runs_avx512},
#endif
#ifdef MANYCONTACT_LEVEL_avx2
    {"avx2", sparse::level_avx2, sparse::blocks_level_avx2, lanes::level_avx2, lanes::level_one_avx2,
     extended::level_avx2, runs_avx2},
#endif
#ifdef MANYCONTACT_LEVEL_baseline
    {"baseline", sparse::level_baseline, sparse::blocks_level_baseline, lanes::level_baseline,
     lanes::level_one_baseline, extended::level_baseline, [] { return true; }},
#endif
};

std::span<const Level> levels_here() {
  std::span<const Level> all(kLevels);
  while (!all.empty() && !all.front().runs()) all = all.subspan(1);
  if (all.empty())
    throw std::runtime_error(std::string("manycontact was compiled for processors with ") + kLevels[0].name +
                             ", which this processor does not have: compile manycontact on this machine, or with "
                             "MANYCONTACT_PORTABLE=ON for all processors");
  return all;
}

}  // namespace

std::span<const Level> levels() {
  static const std::span<const Level> here = levels_here();
  return here;
}

}  // namespace simd
}  // namespace manycontact
