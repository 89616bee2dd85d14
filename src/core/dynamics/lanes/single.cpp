// The kernels of one level of instructions that solve robots alone in single precision, as level.cpp has those of
// doubles. MANYCONTACT_LANES: twice as many robots, and the element, float.

#include "robot_block/alone.hpp"
#include "robot_block/linearise.hpp"
#include "robot_block/terms.hpp"
#include "simd/levels.hpp"

namespace manycontact::lanes {

extern const SingleLevel MANYCONTACT_OF_LEVEL(single_level_);
const SingleLevel MANYCONTACT_OF_LEVEL(single_level_) = {InstantiatedScalar::width,
                                                         make_kernel<SingleBlocks, RobotBlock<InstantiatedScalar>>};

}  // namespace manycontact::lanes
