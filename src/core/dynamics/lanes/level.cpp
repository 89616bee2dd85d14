// The kernels of one level of instructions: the forward path once more, in packs. The file is compiled twice per level
// with that level's flags: for SIMD batches, and for one robot at a time. MANYCONTACT_LEVEL is its name and
// MANYCONTACT_LANES its width. The linker sees the Level alone (src/core/simd/levels.cmake). Otherwise functions that
// are shared with the rest of the program, Eigen's and std's, might come from here and meet an older processor.

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
