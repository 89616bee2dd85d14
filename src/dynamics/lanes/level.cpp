// The kernels of one level of instructions: the forward path once more, in packs. Compiled once per level with that
// level's flags, MANYCONTACT_LEVEL (its name) and MANYCONTACT_LANES (its width); nothing of it but the Level is seen by
// the linker (src/simd/levels.cmake), or functions that it shares with the rest of the program, Eigen's and std's,
// might be taken from here and meet a processor without these instructions.

#include "interface_contacts.hpp"
#include "robot_block/alone.hpp"
#include "robot_block/derivatives.hpp"
#include "robot_block/joined.hpp"
#include "robot_block/linearise.hpp"
#include "robot_block/products.hpp"
#include "robot_block/terms.hpp"
#include "scalar_or_batch.hpp"
#include "simd/levels.hpp"
#include "subtree_batch.hpp"

namespace manycontact::lanes {

namespace {

template <int W, class E>
using Blocks = RobotBlock<Pack<W, E>>;
template <int W, class E>
using MixedBlocks = RobotBlock<Pack<W, E>, Pack<W, float>>;
template <int W, class E>
using Contacts = InterfaceContactsOf<Pack<W, E>>;

class LevelBlocks final : public RobotBlocks {
 public:
  explicit LevelBlocks(std::shared_ptr<const BlockPlan> plan) : plan_(std::move(plan)), work_(plan_) {}
  void reserve_batch() override { work_.reserve_batch(plan_); }
  void solve(const Job& job, std::span<Robot> robots, std::span<Answer> answers) override {
    work_.of(robots.size(), [&](auto& work) { work.solve(job, robots, answers); });
  }
  void differentiate(const DerivativeJob& job, std::span<Robot> robots, double* memory,
                     std::span<const Panel> panels) override {
    work_.of(robots.size(), [&](auto& work) { work.differentiate(job, robots, memory, panels); });
  }
  void jvp(const ProductJob& job, std::span<Robot> robots) override {
    work_.of(robots.size(), [&](auto& work) { work.jvp(job, robots); });
  }
  void vjp(const ProductJob& job, std::span<Robot> robots) override {
    work_.of(robots.size(), [&](auto& work) { work.vjp(job, robots); });
  }
  void evaluate(const Job& job, std::span<Robot> robots, Memory memory) override {
    work_.of(robots.size(), [&](auto& work) { work.evaluate(job, robots, memory); });
  }
  void factor(std::span<Robot> robots, Memory memory) override {
    work_.of(robots.size(), [&](auto& work) { work.factor(robots, memory); });
  }
  void load(const Job& job, std::span<Robot> robots, double* memory) override {
    work_.of(robots.size(), [&](auto& work) { work.load(job, robots, memory); });
  }
  void correct(std::span<Robot> robots, Memory memory) override {
    work_.of(robots.size(), [&](auto& work) { work.correct(robots, memory); });
  }
  void check(std::span<Robot> robots, Memory memory) override {
    work_.of(robots.size(), [&](auto& work) { work.check(robots, memory); });
  }
  void finish(std::span<Robot> robots, Memory memory) override {
    work_.of(robots.size(), [&](auto& work) { work.finish(robots, memory); });
  }
  void store(const Job& job, std::span<Robot> robots, double* memory) override {
    work_.of(robots.size(), [&](auto& work) { work.store(job, robots, memory); });
  }
  void move_ends(const DerivativeJob& job, std::span<Robot> robots) override {
    work_.of(robots.size(), [&](auto& work) { work.move_ends(job, robots); });
  }

 private:
  std::shared_ptr<const BlockPlan> plan_;
  ScalarOrBatch<Blocks, MANYCONTACT_LANES> work_;
};

// The steps of a solve; derivatives and products are those of LevelBlocks.
class LevelMixed final : public SolvingBlocks {
 public:
  explicit LevelMixed(std::shared_ptr<const BlockPlan> plan) : plan_(std::move(plan)), work_(plan_) {}
  void reserve_batch() override { work_.reserve_batch(plan_); }
  void solve(const Job& job, std::span<Robot> robots, std::span<Answer> answers) override {
    work_.of(robots.size(), [&](auto& work) { work.solve(job, robots, answers); });
  }
  void evaluate(const Job& job, std::span<Robot> robots, Memory memory) override {
    work_.of(robots.size(), [&](auto& work) { work.evaluate(job, robots, memory); });
  }
  void factor(std::span<Robot> robots, Memory memory) override {
    work_.of(robots.size(), [&](auto& work) { work.factor(robots, memory); });
  }
  void correct(std::span<Robot> robots, Memory memory) override {
    work_.of(robots.size(), [&](auto& work) { work.correct(robots, memory); });
  }
  void store(const Job& job, std::span<Robot> robots, double* memory) override {
    work_.of(robots.size(), [&](auto& work) { work.store(job, robots, memory); });
  }

 private:
  std::shared_ptr<const BlockPlan> plan_;
  ScalarOrBatch<MixedBlocks, MANYCONTACT_LANES> work_;
};

class LevelContacts final : public InterfaceContacts {
 public:
  LevelContacts(const Scene& scene, const Contact& contact, const ContactSupport& support)
      : work_(scene, contact, support) {
    work_.reserve_batch(scene, contact, support);
  }
  void evaluate(const Vec3<double>& gravity, std::span<Rows> rows) override {
    work_.of(rows.size(), [&](auto& work) { work.evaluate(gravity, rows); });
  }
  void differentiate(const Vec3<double>& gravity, std::span<const Derivatives> rows) override {
    work_.of(rows.size(), [&](auto& work) { work.differentiate(gravity, rows); });
  }

 private:
  ScalarOrBatch<Contacts, MANYCONTACT_LANES> work_;
};

class LevelSubtrees final : public SubtreeBatch {
 public:
  explicit LevelSubtrees(std::shared_ptr<const SubtreePlan> plan) : work_(std::move(plan)) {}
  void solve(std::span<Subtree> subtrees) override { work_.solve(subtrees); }

 private:
  SubtreeBatchOf<Pack<MANYCONTACT_LANES>> work_;
};

std::unique_ptr<RobotBlocks> make(std::shared_ptr<const BlockPlan> plan) {
  return std::make_unique<LevelBlocks>(std::move(plan));
}
std::unique_ptr<SolvingBlocks> make_mixed(std::shared_ptr<const BlockPlan> plan) {
  return std::make_unique<LevelMixed>(std::move(plan));
}
std::unique_ptr<InterfaceContacts> make_contacts(const Scene& scene, const Contact& contact,
                                                 const ContactSupport& support) {
  return std::make_unique<LevelContacts>(scene, contact, support);
}
std::unique_ptr<SubtreeBatch> make_subtrees(std::shared_ptr<const SubtreePlan> plan) {
  return std::make_unique<LevelSubtrees>(std::move(plan));
}

}  // namespace

extern const SingleLevel MANYCONTACT_OF_LEVEL(single_level_);
extern const Level MANYCONTACT_OF_LEVEL(level_);
const Level MANYCONTACT_OF_LEVEL(level_) = {MANYCONTACT_LANES, make,          make_mixed,
                                            make_contacts,     make_subtrees, MANYCONTACT_OF_LEVEL(single_level_)};

}  // namespace manycontact::lanes
