// Every method in every order is compared with the dense reference solver, on every scene, at rest and in motion, and
// again after the data have seen other states and other contacts.

#include "support/methods.hpp"

#include <gtest/gtest.h>

#include "manycontact/dynamics/shapes.hpp"
#include "manycontact/dynamics/views.hpp"
#include "support/measure.hpp"
#include "support/random.hpp"
#include "support/scenes.hpp"
#include "support/workspace.hpp"

namespace manycontact::test {
namespace {

struct State {
  Eigen::VectorXd q, v, u;
};

// Contains the dense reference solution and the errors allowed to the others.
struct Reference {
  Reference(const Scene& scene, const State& s, const std::vector<char>& active)
      : data(scene, {Method::kDense, {}}), a_free(free_accelerations(scene, s.q, s.v, s.u)) {
    data.active = active;
    (void)solve(scene, s.q, s.v, s.u, data);
    condition = conditions(scene, data);
  }

  SceneData data;
  Eigen::VectorXd a_free;
  std::vector<double> condition;
};

void solve_at(const Scene& scene, const State& s, SceneData& data) {
  data.a.setConstant(std::numeric_limits<double>::quiet_NaN());
  data.f.setConstant(std::numeric_limits<double>::quiet_NaN());
  (void)solve(scene, s.q, s.v, s.u, data);
}

class Methods : public testing::TestWithParam<std::string> {
 protected:
  void SetUp() override {
    file_ = load_scene(GetParam());
    rest_ = {file_.q, file_.v, file_.u};
    std::mt19937 rng(7);
    disturb(file_, rng);
    moving_ = {file_.q, file_.v, file_.u};
    all_.assign(scene().contacts.size(), 1);
    for (std::size_t c = 0; c < all_.size(); ++c) all_[c] = scene().contacts[c].active;
  }

  const Scene& scene() const { return file_.scene; }

  // With `equilibrium` forces may balance, and accelerations vanish up to rounding error.
  void expect_like(const Reference& reference, const SceneData& data, bool equilibrium = false) const {
    const bool redundant = reference.data.report.status != Status::kOk;
    if (redundant && data.options.method == Method::kDenseSchur) {
      EXPECT_EQ(data.report.status, Status::kFailed);
      return;
    }
    EXPECT_EQ(data.report.status, reference.data.report.status);
    if (scene().damping == 0) {
      EXPECT_EQ(data.report.rank, reference.data.report.rank);
    }
    const Errors e = errors<double>(scene(), data, reference.data.a, reference.data.f, reference.condition,
                                    equilibrium ? reference.a_free : Eigen::VectorXd());
    EXPECT_LE(e.excess, 1) << e;
    if (data.options.method != Method::kDenseSchur && reference.data.report.status != Status::kInconsistent) {
      EXPECT_LE(data.report.residual_dynamics, 1e-14);  // the baseline does not refine
      EXPECT_LE(data.report.residual_contact, 1e-14);
    }
    for (const IslandReport& island : data.report.islands)
      if (!equilibrium) {
        EXPECT_LE(island.refinement_steps, 2);  // the factor belongs to the right matrix
      }
    if (!(e.excess <= worst_)) worst_ = e.excess;
  }

  // Returns every other contact, or all but the first.
  std::vector<char> fewer(bool alternate) const {
    std::vector<char> active = all_;
    for (std::size_t c = 0; c < active.size(); ++c)
      if (alternate ? c % 2 == 1 : c == 0) active[c] = 0;
    return active;
  }

  SceneFile file_;
  State rest_, moving_;
  std::vector<char> all_;
  mutable double worst_ = 0;
};

TEST_P(Methods, AgreeWithTheOracle) {
  const Reference rest(scene(), rest_, all_), moving(scene(), moving_, all_);
  for (const Way& way : ways_here()) {
    SCOPED_TRACE(way.name);
    SceneData at_rest(scene(), way.options), in_motion(scene(), way.options);
    solve_at(scene(), rest_, at_rest);
    expect_like(rest, at_rest, true);
    solve_at(scene(), moving_, in_motion);
    expect_like(moving, in_motion);
  }
  RecordProperty("worst_error_over_allowed", std::to_string(worst_));
}

// All methods estimate one number with different factors, each within a factor of three of it from below.
TEST_P(Methods, AgreeOnTheCondition) {
  const Reference reference(scene(), moving_, all_);
  for (const Way& way : ways_here()) {
    SCOPED_TRACE(way.name);
    SceneData data(scene(), way.options);
    solve_at(scene(), moving_, data);
    const std::vector<double> condition = conditions(scene(), data);
    EXPECT_EQ(data.report.condition, *std::max_element(condition.begin(), condition.end()));
    if (way.options.method == Method::kDenseSchur) {  // one system: no better than the worst island's
      EXPECT_EQ(condition.size(), scene().robots.empty() ? 0u : 1u);
      EXPECT_GE(data.report.condition, reference.data.report.condition / 3);
      continue;
    }
    for (std::size_t i = 0; i < condition.size(); ++i) {
      if (data.report.islands[i].status == Status::kFailed) {
        EXPECT_EQ(condition[i], std::numeric_limits<double>::infinity());
        continue;
      }
      EXPECT_LE(condition[i], 3 * reference.condition[i]);
      EXPECT_GE(condition[i], reference.condition[i] / 3);
    }
  }
}

TEST_P(Methods, ForgetTheStateBefore) {
  for (const Way& way : ways(true)) {
    SCOPED_TRACE(way.name);
    SceneData fresh(scene(), way.options), used(scene(), way.options);
    solve_at(scene(), moving_, fresh);
    solve_at(scene(), rest_, used);
    solve_at(scene(), moving_, used);
    EXPECT_EQ(fresh.report.status, used.report.status);
    if (fresh.report.status == Status::kFailed) continue;
    EXPECT_TRUE(fresh.a == used.a);  // the same bits
    EXPECT_TRUE(fresh.f == used.f);
  }
}

TEST_P(Methods, ForgetTheContactsBefore) {
  if (all_.empty()) GTEST_SKIP() << "no contacts";
  const std::vector<std::vector<char>> sets = {all_, fewer(true), fewer(false), std::vector<char>(all_.size(), 0)};
  for (const Way& way : ways(true)) {
    SCOPED_TRACE(way.name);
    SceneData switched(scene(), way.options);
    std::size_t shapes = 0;
    for (int round = -1; round < 2; ++round) {  // new pairs in the first round drop earlier analyses
      for (const std::vector<char>& active : sets) {
        switched.active = active;
        solve_at(scene(), moving_, switched);
        SceneData fresh(scene(), way.options);
        fresh.active = active;
        solve_at(scene(), moving_, fresh);
        EXPECT_EQ(switched.report.status, fresh.report.status);
        if (fresh.report.status == Status::kFailed) continue;
        EXPECT_TRUE(fresh.a == switched.a);
        EXPECT_TRUE(fresh.f == switched.f);
      }
      // Sets seen before are looked up, not analysed again.
      if (round < 1) shapes = shapes_analysed(switched);
      EXPECT_EQ(shapes_analysed(switched), shapes);
    }
  }
}

TEST_P(Methods, ForgetTheMethodBefore) {
  SceneData switched(scene());
  for (int round = 0; round < 2; ++round)
    for (const Way& way : ways(true)) {
      SCOPED_TRACE(way.name);
      switched.options = way.options;
      solve_at(scene(), moving_, switched);
      SceneData fresh(scene(), way.options);
      solve_at(scene(), moving_, fresh);
      EXPECT_EQ(switched.report.status, fresh.report.status);
      ASSERT_EQ(switched.report.islands.size(), fresh.report.islands.size());
      for (std::size_t i = 0; i < fresh.report.islands.size(); ++i)
        EXPECT_EQ(switched.report.islands[i].method, fresh.report.islands[i].method);
      if (fresh.report.status == Status::kFailed) continue;
      EXPECT_TRUE(fresh.a == switched.a);
      EXPECT_TRUE(fresh.f == switched.f);
    }
}

TEST_P(Methods, AgreeWithTheOracleWithFewerContacts) {
  if (all_.empty()) GTEST_SKIP() << "no contacts";
  for (const std::vector<char>& active : {fewer(true), fewer(false)}) {
    const Reference reference(scene(), moving_, active);
    for (const Way& way : ways_here()) {
      SCOPED_TRACE(way.name);
      SceneData data(scene(), way.options);
      data.active = active;
      solve_at(scene(), moving_, data);
      expect_like(reference, data);
    }
  }
}

GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(Methods);
INSTANTIATE_TEST_SUITE_P(Models, Methods, testing::ValuesIn(model_scenes()), scene_title);
INSTANTIATE_TEST_SUITE_P(Golden, Methods, testing::ValuesIn(golden_scenes()), scene_title);

// One shape is analysed once, however many islands have it.
TEST(Patterns, AreSharedByAlikeIslands) {
  const SceneFile file = load_scene(MANYCONTACT_SOURCE_DIR "/models/herd.xml");
  SceneData data(file.scene, {Method::kSparseLdl, Order::kLeafToRoot});
  ASSERT_EQ(island_count(data), 64u);
  EXPECT_EQ(shapes_analysed(data), 1u);
  for (std::size_t i = 0; i < 64; ++i) EXPECT_EQ(shape_of(data, i), shape_of(data, 0));
}

TEST(RandomScenes, MethodsAgreeWithTheOracle) {
  for (int seed = 1; seed <= 60; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937 rng(seed);
    SceneOptions options;
    options.nrobots = 1 + seed % 4;
    options.damping = seed % 3 == 0 ? 1e-3 : 0;
    options.redundant = seed % 5 == 0 ? 2 : 0;
    options.contradicting = seed % 10 == 0 ? 1 : 0;
    const RandomScene s = random_scene(rng, options);
    SceneData oracle(s.scene, {Method::kDense, {}});
    const Status status = solve(s.scene, s.q, s.v, s.u, oracle).status;
    const std::vector<double> condition = conditions(s.scene, oracle);
    ASSERT_NE(status, Status::kFailed);
    for (const Way& way : ways_here()) {
      SCOPED_TRACE(way.name);
      SceneData data(s.scene, way.options);
      (void)solve(s.scene, s.q, s.v, s.u, data);
      if (status != Status::kOk && way.options.method == Method::kDenseSchur) {
        EXPECT_EQ(data.report.status, Status::kFailed);
        continue;
      }
      EXPECT_EQ(data.report.status, status);
      const Errors e = errors<double>(s.scene, data, oracle.a, oracle.f, condition);
      EXPECT_LE(e.excess, 1) << e;
    }
  }
}

}  // namespace
}  // namespace manycontact::test
