#pragma once
// Tables of all modules' kernels, compiled once per SIMD level (src/core/simd/levels.cmake) and chosen at run time.

#include <span>

/// MANYCONTACT_OF_LEVEL(level_) is level_avx2 in sources compiled for avx2. The other macros are its steps.
#define MANYCONTACT_PASTE(prefix, level) prefix##level
#define MANYCONTACT_PASTE_VALUES(prefix, level) MANYCONTACT_PASTE(prefix, level)
#define MANYCONTACT_OF_LEVEL(prefix) MANYCONTACT_PASTE_VALUES(prefix, MANYCONTACT_LEVEL)

/// MANYCONTACT_LEVEL_NAME is the name of the level as a string. The other macros are its steps.
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
  const lanes::Level &robots, &one_robot;  // kernels for SIMD batches of robots; for single robots
  const extended::Level& equations;
  bool (*runs)();  // whether this processor supports the level's instructions
};

/// Returns the levels of this build that the processor supports, the widest first. @throws std::runtime_error if none
std::span<const Level> levels();

}  // namespace simd
}  // namespace manycontact
