// The kernels of one level of instructions that solve robots alone in single precision, as level.cpp has those of
// doubles. MANYCONTACT_LANES: twice as many robots, and the element, float.

#include "robot_block/alone.hpp"
#include "robot_block/linearise.hpp"
#include "robot_block/terms.hpp"
#include "scalar_or_batch.hpp"
#include "simd/levels.hpp"

namespace manycontact::lanes {

namespace {

template <int W, class E>
using Blocks = RobotBlock<Pack<W, E>>;

class LevelSingle final : public SingleBlocks {
 public:
  explicit LevelSingle(std::shared_ptr<const BlockPlan> plan) : plan_(std::move(plan)), work_(plan_) {}
  void reserve_batch() override { work_.reserve_batch(plan_); }
  void solve(const Job& job, std::span<RobotBlocks::Robot> robots, std::span<Answer> answers) override {
    work_.of(robots.size(), [&](auto& work) { work.solve(job, robots, answers); });
  }

 private:
  std::shared_ptr<const BlockPlan> plan_;
  ScalarOrBatch<Blocks, MANYCONTACT_LANES> work_;
};

std::unique_ptr<SingleBlocks> make(std::shared_ptr<const BlockPlan> plan) {
  return std::make_unique<LevelSingle>(std::move(plan));
}

}  // namespace

extern const SingleLevel MANYCONTACT_OF_LEVEL(single_level_);
const SingleLevel MANYCONTACT_OF_LEVEL(single_level_) = {InstantiatedScalar::width, make};

}  // namespace manycontact::lanes
