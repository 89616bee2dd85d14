#include <string_view>

#include "simd/levels.hpp"

namespace manycontact::extended {

struct Level;  // src/core/dynamics/extended/equations.hpp, as is
const Level& level_here();

extern const Level level_baseline, level_avx2;

// Double-double needs the fused product alone, and gains nothing from wider registers.
const Level& level_here() {
#ifndef MANYCONTACT_LEVEL_baseline
  return level_avx2;
#elif defined(MANYCONTACT_LEVEL_avx2)
  return simd::levels().front().name == std::string_view("baseline") ? level_baseline : level_avx2;
#else
  return level_baseline;
#endif
}

}  // namespace manycontact::extended
