// Kernels of one instruction level for single-robot islands in single precision (level.cpp has those in double
// precision). MANYCONTACT_LANES contains the number of robots, twice that of doubles, and the element type float.

#include "robot_block/alone.hpp"
#include "robot_block/linearise.hpp"
#include "robot_block/terms.hpp"
#include "simd/levels.hpp"

namespace manycontact::lanes {

extern const SingleLevel MANYCONTACT_OF_LEVEL(single_level_);
const SingleLevel MANYCONTACT_OF_LEVEL(single_level_) = {InstantiatedScalar::width,
                                                         make_kernel<SingleBlocks, RobotBlock<InstantiatedScalar>>};

}  // namespace manycontact::lanes
