// The kernels of one level of instructions: the forward path once more, in packs. Compiled once per level with that
// level's flags, MANYCONTACT_LEVEL (its name) and MANYCONTACT_LANES (its width); nothing of it but the Level is seen by
// the linker (src/simd/levels.cmake), or functions that it shares with the rest of the program, Eigen's and std's, might be
// taken from here and meet a processor without these instructions.

#include <optional>

#include "cut_side_by_side.hpp"
#include "derivatives.hpp"
#include "parts_side_by_side.hpp"
#include "side_by_side.hpp"
#include "simd/levels.hpp"
#include "terms.hpp"

namespace manycontact::lanes {

namespace {

// Work of one robot, island or contact; once widened, of as many as fit side by side. The arguments are those of Work.
template <template <class> class Work>
class AloneOrTogether {
 public:
  template <class... Arguments>
  explicit AloneOrTogether(const Arguments&... arguments) : alone_(arguments...) {}
  template <class... Arguments>
  void widen(const Arguments&... arguments) {
    if (!together_) together_.emplace(arguments...);
  }
  /// use(work) on the one for so many.
  template <class Use>
  void of(std::size_t count, Use&& use) {
    if (count == 1)
      use(alone_);
    else
      use(*together_);
  }

 private:
  Work<Pack<1>> alone_;
  std::optional<Work<Pack<MANYCONTACT_LANES>>> together_;
};

class LevelKernel final : public Kernel {
 public:
  LevelKernel(const Scene& scene, const Island& island, const IslandSupport& support,
              const std::shared_ptr<const KktPattern>& pattern)
      : work_(scene, island, support, pattern) {}
  void widen(const Scene& scene, const Island& island, const IslandSupport& support,
             std::shared_ptr<const KktPattern> pattern) override {
    work_.widen(scene, island, support, pattern);
  }
  void solve(const Job& job, std::span<const Island* const> islands, std::span<Answer> answers) override {
    work_.of(islands.size(), [&](auto& robots) { robots.solve(job, islands, answers); });
  }
  void differentiate(const DerivativeJob& job, std::span<const Island* const> islands,
                     std::span<const Panel> panels) override {
    work_.of(islands.size(), [&](auto& robots) { robots.differentiate(job, islands, panels); });
  }
  void jvp(const ProductJob& job, std::span<const Island* const> islands) override {
    work_.of(islands.size(), [&](auto& robots) { robots.jvp(job, islands); });
  }
  void vjp(const ProductJob& job, std::span<const Island* const> islands) override {
    work_.of(islands.size(), [&](auto& robots) { robots.vjp(job, islands); });
  }

 private:
  AloneOrTogether<SideBySide> work_;
};

class LevelRobots final : public RobotTerms {
 public:
  explicit LevelRobots(std::shared_ptr<const Model> model) : model_(std::move(model)), work_(model_) {}
  void widen() override { work_.widen(model_); }
  void evaluate(const Vec3<double>& gravity, std::span<Robot> robots) override {
    work_.of(robots.size(), [&](auto& work) { work.evaluate(gravity, robots); });
  }

 private:
  std::shared_ptr<const Model> model_;
  AloneOrTogether<RobotTermsOf> work_;
};

class LevelContacts final : public ContactTerms {
 public:
  LevelContacts(const Scene& scene, const Contact& contact, const ContactSupport& support)
      : work_(scene, contact, support) {}
  void widen(const Scene& scene, const Contact& contact, const ContactSupport& support) override {
    work_.widen(scene, contact, support);
  }
  void evaluate(const Vec3<double>& gravity, const Contact& contact, std::span<const Rows> rows) override {
    work_.of(rows.size(), [&](auto& work) { work.evaluate(gravity, contact, rows); });
  }
  void evaluate(const Vec3<double>& gravity, std::span<JoiningRows> rows) override {
    work_.of(rows.size(), [&](auto& work) { work.evaluate(gravity, rows); });
  }

 private:
  AloneOrTogether<ContactTermsOf> work_;
};

class LevelCutRobots final : public CutRobots {
 public:
  explicit LevelCutRobots(std::shared_ptr<const CutRobot> cut) : cut_(std::move(cut)), work_(cut_) {}
  void widen() override { work_.widen(cut_); }
  std::size_t width(bool one) const override { return one ? 1 : MANYCONTACT_LANES; }
  void evaluate(const Job& job, std::span<Robot> robots, Memory memory) override {
    work_.of(robots.size(), [&](auto& work) { work.evaluate(job, robots, memory); });
  }
  void factor(std::span<Robot> robots, Memory memory) override {
    work_.of(robots.size(), [&](auto& work) { work.factor(robots, memory); });
  }
  void load(const Job& job, std::span<const Robot> robots, double* memory) override {
    work_.of(robots.size(), [&](auto& work) { work.load(job, robots, memory); });
  }
  void correct(std::span<Robot> robots, Memory memory) override {
    work_.of(robots.size(), [&](auto& work) { work.correct(robots, memory); });
  }
  void store(const Job& job, std::span<const Robot> robots, double* memory) override {
    work_.of(robots.size(), [&](auto& work) { work.store(job, robots, memory); });
  }

 private:
  std::shared_ptr<const CutRobot> cut_;
  AloneOrTogether<CutSideBySide> work_;
};

class LevelParts final : public Parts {
 public:
  explicit LevelParts(std::shared_ptr<const PartPlan> plan) : work_(std::move(plan)) {}
  void solve(std::span<Part> parts) override { work_.solve(parts); }

 private:
  PartsSideBySide<Pack<MANYCONTACT_LANES>> work_;
};

std::unique_ptr<Kernel> make(const Scene& scene, const Island& island, const IslandSupport& support,
                             std::shared_ptr<const KktPattern> pattern) {
  return std::make_unique<LevelKernel>(scene, island, support, pattern);
}
std::unique_ptr<CutRobots> make_cut(std::shared_ptr<const CutRobot> robot) {
  return std::make_unique<LevelCutRobots>(std::move(robot));
}
std::unique_ptr<RobotTerms> make_robots(std::shared_ptr<const Model> model) {
  return std::make_unique<LevelRobots>(std::move(model));
}
std::unique_ptr<ContactTerms> make_contacts(const Scene& scene, const Contact& contact, const ContactSupport& support) {
  return std::make_unique<LevelContacts>(scene, contact, support);
}

std::unique_ptr<Parts> make_parts(std::shared_ptr<const PartPlan> plan) {
  return std::make_unique<LevelParts>(std::move(plan));
}

}  // namespace

extern const Level MANYCONTACT_OF_LEVEL(level_);
const Level MANYCONTACT_OF_LEVEL(level_) = {MANYCONTACT_LEVEL_NAME, MANYCONTACT_LANES, make,      make_robots,
                                            make_contacts,          make_cut,          make_parts};

}  // namespace manycontact::lanes
