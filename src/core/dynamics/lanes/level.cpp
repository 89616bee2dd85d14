// Kernels of one instruction level. This file is compiled twice with the level's flags: for SIMD batches and for one
// robot. MANYCONTACT_LEVEL is the level's name, MANYCONTACT_LANES its width. Only the Level has external linkage
// (src/core/simd/levels.cmake): inline functions linked from here into other code would fail on older processors.

#include "interface_contacts.hpp"
#include "robot_block/alone.hpp"
#include "robot_block/derivatives.hpp"
#include "robot_block/joined.hpp"
#include "robot_block/linearise.hpp"
#include "robot_block/products.hpp"
#include "robot_block/terms.hpp"
#include "simd/levels.hpp"
#include "subtree_batch.hpp"

namespace manycontact::lanes {

namespace {

std::unique_ptr<SubtreeBatch> make_subtrees(const std::shared_ptr<const SubtreePlan>& plan) {
  if constexpr (InstantiatedScalar::width > 1)
    return std::make_unique<SubtreeBatchOf<InstantiatedScalar>>(plan);
  else
    return nullptr;
}

}  // namespace

extern const SingleLevel MANYCONTACT_OF_LEVEL(single_level_);
extern const Level MANYCONTACT_OF_LEVEL(level_);
const Level MANYCONTACT_OF_LEVEL(level_) = {InstantiatedScalar::width,
                                            make_kernel<RobotBlocks, RobotBlock<InstantiatedScalar>>,
                                            make_kernel<InterfaceContacts, InterfaceContactsOf<InstantiatedScalar>>,
                                            make_subtrees, MANYCONTACT_OF_LEVEL(single_level_)};

}  // namespace manycontact::lanes
