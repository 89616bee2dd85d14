// The kernels of one level of instructions: the forward path once more, in packs. Compiled once per level with that
// level's flags, MANYCONTACT_LEVEL (its name) and MANYCONTACT_LANES (its width); nothing of it but the Level is seen by
// the linker (src/lanes.cmake), or functions that it shares with the rest of the program, Eigen's and std's, might be
// taken from here and meet a processor without these instructions.

#include <optional>

#include "../../algorithm/crba.cpp"
#include "../../algorithm/kinematics.cpp"
#include "../../algorithm/rnea.cpp"
#include "../../algorithm/rnea_derivatives.cpp"
#include "../../algorithm/rnea_products.cpp"
#include "cut_side_by_side.hpp"
#include "derivatives.hpp"
#include "manycontact/sparse/instruction_levels.hpp"
#include "manycontact/spatial/explog.hpp"
#include "parts_side_by_side.hpp"
#include "side_by_side.hpp"
#include "terms.hpp"

namespace manycontact {

// These have branches, so lane by lane.
template <int W, class Function>
auto lane_by_lane(const SE3<Pack<W>>& M, Function&& function) {
  SE3<double> of_lane;
  using Result = decltype(function(of_lane));
  Eigen::Matrix<Pack<W>, Result::RowsAtCompileTime, Result::ColsAtCompileTime> out;
  for (int l = 0; l < W; ++l) {
    for (int i = 0; i < 9; ++i) of_lane.R.data()[i] = M.R.data()[i][l];
    for (int i = 0; i < 3; ++i) of_lane.p[i] = M.p[i][l];
    const Result x = function(of_lane);
    for (Eigen::Index i = 0; i < x.size(); ++i) out.data()[i].set(l, x.data()[i]);
  }
  return out;
}
template <int W>
Vec6<Pack<W>> log6(const SE3<Pack<W>>& M) {
  return lane_by_lane(M, [](const SE3<double>& m) { return log6<double>(m); });
}
template <int W>
Mat6<Pack<W>> log6_derivative(const SE3<Pack<W>>& M) {
  return lane_by_lane(M, [](const SE3<double>& m) { return log6_derivative<double>(m); });
}

}  // namespace manycontact

#include "../../contact/derivatives.cpp"
#include "../../contact/products.cpp"
#include "../../contact/rows.cpp"

namespace manycontact::lanes {

namespace {

class LevelKernel final : public Kernel {
 public:
  LevelKernel(const Scene& scene, const Island& island, const IslandSupport& support,
              std::shared_ptr<const KktPattern> pattern)
      : alone_(scene, island, support, pattern) {}
  void widen(const Scene& scene, const Island& island, const IslandSupport& support,
             std::shared_ptr<const KktPattern> pattern) override {
    if (!together_) together_.emplace(scene, island, support, std::move(pattern));
  }
  void solve(const Job& job, std::span<const Island* const> islands, std::span<Answer> answers) override {
    with(islands, [&](auto& robots) { robots.solve(job, islands, answers); });
  }
  void differentiate(const DerivativeJob& job, std::span<const Island* const> islands,
                     std::span<const Panel> panels) override {
    with(islands, [&](auto& robots) { robots.differentiate(job, islands, panels); });
  }
  void jvp(const ProductJob& job, std::span<const Island* const> islands) override {
    with(islands, [&](auto& robots) { robots.jvp(job, islands); });
  }
  void vjp(const ProductJob& job, std::span<const Island* const> islands) override {
    with(islands, [&](auto& robots) { robots.vjp(job, islands); });
  }

 private:
  template <class Work>
  void with(std::span<const Island* const> islands, Work&& work) {
    if (islands.size() == 1)
      work(alone_);
    else
      work(*together_);
  }

  SideBySide<Pack<1>> alone_;
  std::optional<SideBySide<Pack<MANYCONTACT_LANES>>> together_;
};

std::unique_ptr<Kernel> make(const Scene& scene, const Island& island, const IslandSupport& support,
                             std::shared_ptr<const KktPattern> pattern) {
  return std::make_unique<LevelKernel>(scene, island, support, std::move(pattern));
}

class LevelRobots final : public RobotTerms {
 public:
  explicit LevelRobots(std::shared_ptr<const Model> model) : model_(std::move(model)), alone_(model_) {}
  void widen() override {
    if (!together_) together_.emplace(model_);
  }
  void evaluate(const Vec3<double>& gravity, std::span<Robot> robots) override {
    if (robots.size() == 1)
      alone_.evaluate(gravity, robots);
    else
      together_->evaluate(gravity, robots);
  }

 private:
  std::shared_ptr<const Model> model_;
  RobotTermsOf<Pack<1>> alone_;
  std::optional<RobotTermsOf<Pack<MANYCONTACT_LANES>>> together_;
};

class LevelContacts final : public ContactTerms {
 public:
  LevelContacts(const Scene& scene, const Contact& contact, const ContactSupport& support)
      : alone_(scene, contact, support) {}
  void widen(const Scene& scene, const Contact& contact, const ContactSupport& support) override {
    if (!together_) together_.emplace(scene, contact, support);
  }
  void evaluate(const Vec3<double>& gravity, const Contact& contact, std::span<const Rows> rows) override {
    if (rows.size() == 1)
      alone_.evaluate(gravity, contact, rows);
    else
      together_->evaluate(gravity, contact, rows);
  }
  void evaluate(const Vec3<double>& gravity, std::span<JoiningRows> rows) override {
    if (rows.size() == 1)
      alone_.evaluate(gravity, rows);
    else
      together_->evaluate(gravity, rows);
  }

 private:
  ContactTermsOf<Pack<1>> alone_;
  std::optional<ContactTermsOf<Pack<MANYCONTACT_LANES>>> together_;
};

class LevelCutRobots final : public CutRobots {
 public:
  explicit LevelCutRobots(std::shared_ptr<const CutRobot> cut) : cut_(std::move(cut)), alone_(cut_) {}
  void widen() override {
    if (!together_) together_.emplace(cut_);
  }
  std::size_t memory(bool one) const override { return one ? alone_.memory() : MANYCONTACT_LANES * alone_.memory(); }
  void evaluate(const Job& job, std::span<Robot> robots, double* memory) override {
    with(*this, robots, [&](auto& work) { work.evaluate(job, robots, memory); });
  }
  void factor(std::span<Robot> robots, double* memory) override {
    with(*this, robots, [&](auto& work) { work.factor(robots, memory); });
  }
  void load(const Job& job, std::span<const Robot> robots, double* memory) override {
    with(*this, robots, [&](auto& work) { work.load(job, robots, memory); });
  }
  void correct(std::span<Robot> robots, double* memory) override {
    with(*this, robots, [&](auto& work) { work.correct(robots, memory); });
  }
  void store(const Job& job, std::span<const Robot> robots, double* memory) const override {
    with(*this, robots, [&](auto& work) { work.store(job, robots, memory); });
  }

 private:
  template <class Self, class Robots, class Work>
  static void with(Self& self, Robots robots, Work&& work) {
    if (robots.size() == 1)
      work(self.alone_);
    else
      work(*self.together_);
  }

  std::shared_ptr<const CutRobot> cut_;
  CutSideBySide<Pack<1>> alone_;
  std::optional<CutSideBySide<Pack<MANYCONTACT_LANES>>> together_;
};

class LevelParts final : public Parts {
 public:
  explicit LevelParts(std::shared_ptr<const PartPlan> plan) : work_(std::move(plan)) {}
  void solve(std::span<Part> parts) override { work_.solve(parts); }

 private:
  PartsSideBySide<Pack<MANYCONTACT_LANES>> work_;
};

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
