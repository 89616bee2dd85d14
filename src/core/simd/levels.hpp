#pragma once
// The kernels of all modules, compiled once per instruction level (src/core/simd/levels.cmake) and chosen at run time.

#include <span>

/// The name of a level's kernels: MANYCONTACT_OF_LEVEL(level_) is level_avx2 in the source compiled for avx2.
#define MANYCONTACT_PASTE(prefix, level) prefix##level
#define MANYCONTACT_PASTE_VALUES(prefix, level) MANYCONTACT_PASTE(prefix, level)
#define MANYCONTACT_OF_LEVEL(prefix) MANYCONTACT_PASTE_VALUES(prefix, MANYCONTACT_LEVEL)

/// The level as a string.
#define MANYCONTACT_QUOTE(level) #level
#define MANYCONTACT_QUOTE_VALUE(level) MANYCONTACT_QUOTE(level)
#define MANYCONTACT_LEVEL_NAME MANYCONTACT_QUOTE_VALUE(MANYCONTACT_LEVEL)

namespace manycontact {

namespace sparse {
struct PanelKernels;  // manycontact/sparse/panel_kernels.hpp
struct DenseKernels;  // manycontact/sparse/dense_kernels.hpp
}  // namespace sparse
namespace lanes {
struct Level;  // src/core/dynamics/lanes/lanes.hpp
}
namespace extended {
struct Level;  // src/core/dynamics/extended/equations.hpp
}

namespace simd {

struct Level {
  const char* name;
  const sparse::PanelKernels& panels;
  const sparse::DenseKernels& blocks;
  const lanes::Level &robots, &one_robot;  // SIMD batches of robots; single robots
  const extended::Level& equations;
  bool (*runs)();  // whether this processor has the instructions
};

/// All levels of this build whose instructions this processor has, the widest first.
/// @throws std::runtime_error if there are none: the build was for another processor only
std::span<const Level> levels();

}  // namespace simd
}  // namespace manycontact
