// The kernels of one level of instructions: the forward path once more, in packs. Compiled once per level with that
// level's flags, MANYCONTACT_LEVEL (its name) and MANYCONTACT_LANES (its width); nothing of it but the Level is seen by
// the linker (src/core/simd/levels.cmake), or functions that it shares with the rest of the program, Eigen's and std's,
// might be taken from here and meet a processor without these instructions.

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
