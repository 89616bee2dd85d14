// Memory runs out at each allocation in turn: an exception is thrown, nothing leaks, and the same data give correct
// solutions afterwards.

#include <gtest/gtest.h>

#include <optional>

#include "manycontact/dynamics/differentiate.hpp"
#include "manycontact/dynamics/jvp.hpp"
#include "manycontact/dynamics/solve.hpp"
#include "manycontact/io/input_error.hpp"
#include "support/allocations.hpp"
#include "support/methods.hpp"
#include "support/random.hpp"
#include "support/scenes.hpp"

namespace manycontact::test {
namespace {

using Eigen::VectorXd;

struct FailingAllocations : testing::Test {
  void SetUp() override {
    if (!MANYCONTACT_FAILS_ALLOCATIONS) GTEST_SKIP() << "malloc cannot be made to fail here";
    std::mt19937 rng(3);
    disturb(file, rng);
  }
  void solve_at(SceneData& data) const { (void)solve(file.scene, file.q, file.v, file.u, data); }

  SceneFile file = load_small(kModels + "arm_pushes_box.xml");
};

// This is a sample of thousands, mostly in libraries that read XML, which may report that a file cannot be read.
TEST_F(FailingAllocations, Loading) {
  const std::string path = kModels + "humanoid_standing.xml";
  int failed = 0;
  for (long k = 0;; k += 61, ++failed) {
    bool reached = false;
    try {
      const FailingAllocation failing(k, k % 2);
      try {
        (void)load_scene(path);
      } catch (...) {
        reached = failing.reached();
        throw;
      }
      reached = failing.reached();
    } catch (const std::bad_alloc&) {
    } catch (const InputError&) {
    }
    if (!reached) break;
  }
  EXPECT_GT(failed, 50);
  EXPECT_EQ(load_scene(path).scene.nrobots(), 1);
}

TEST_F(FailingAllocations, Constructing) {
  const FailedRuns runs = fail_each_allocation([&] { SceneData data(file.scene); }, [] {});
  EXPECT_GT(runs.failed, 100);
}

// The allocations are those of the first solve and of the first derivatives of new data.
TEST_F(FailingAllocations, SolvingAndDifferentiating) {
  for (const Way& way : ways(true)) {
    if (way.options.order) continue;  // orders allocate alike
    SCOPED_TRACE(way.name);
    SceneData expected(file.scene, way.options);
    solve_at(expected);
    differentiate(file.scene, expected);
    const Eigen::MatrixXd da_dq = dense_derivatives(file.scene, expected).da_dq;
    std::optional<SceneData> data(std::in_place, file.scene, way.options);
    const FailedRuns runs = fail_each_allocation(
        [&] {
          solve_at(*data);
          differentiate(file.scene, *data);
        },
        [&] {
          solve_at(*data);
          differentiate(file.scene, *data);
          EXPECT_TRUE(data->a == expected.a);
          EXPECT_TRUE(data->f == expected.f);
          EXPECT_TRUE(dense_derivatives(file.scene, *data).da_dq == da_dq);
          data.emplace(file.scene, way.options);
        },
        true);
    EXPECT_GT(runs.failed, 1);
  }
}

// Results of the current solution are requested twice: a factor that was never finished is not used. Rows are
// independent, or all contacts are there twice.
TEST_F(FailingAllocations, AskingOnceMore) {
  for (const bool twice : {false, true}) {
    Scene scene = file.scene;
    for (Contact contact : std::vector<Contact>(twice ? scene.contacts : std::vector<Contact>{})) {
      contact.name += " again";
      add_contact(scene, contact);
    }
    const VectorXd x = VectorXd::Ones(scene.nv), u = VectorXd::Ones(scene.nu);
    for (const Way& way : ways(true)) {
      if (way.options.order) continue;
      const bool of_few = way.options.method == Method::kAuto || way.options.method == Method::kSparseBodies;
      if (twice && !of_few) continue;  // the others drop rows in the way of auto
      SCOPED_TRACE(way.name + (twice ? ", contacts twice" : ""));
      VectorXd da(scene.nv);
      const auto ask = [&](SceneData& data) {
        VectorXd df(data.f.size());
        jvp(scene, data, x, x, u, da, df);
        VectorXd wq(scene.nv), wv(scene.nv), wu(scene.nu);
        vjp(scene, data, x, df, wq, wv, wu);
        estimate_condition(scene, data);
        estimate_errors(scene, data);
        differentiate(scene, data);
        return estimate_derivative_errors(scene, data).front().da_dq;
      };
      SceneData expected(scene, way.options);
      (void)solve(scene, file.q, file.v, file.u, expected);
      const double bound = ask(expected), error = expected.report.error_acceleration;
      const VectorXd expected_da = da;
      const Eigen::MatrixXd da_dq = dense_derivatives(scene, expected).da_dq;
      std::optional<SceneData> data;
      const auto solve_anew = [&] {
        data.emplace(scene, way.options);
        (void)solve(scene, file.q, file.v, file.u, *data);
      };
      solve_anew();
      const FailedRuns runs = fail_each_allocation([&] { (void)ask(*data); },
                                                   [&] {
                                                     EXPECT_EQ(ask(*data), bound);
                                                     EXPECT_EQ(data->report.error_acceleration, error);
                                                     EXPECT_TRUE(da == expected_da);
                                                     EXPECT_TRUE(dense_derivatives(scene, *data).da_dq == da_dq);
                                                     solve_anew();
                                                   },
                                                   true);
      EXPECT_GT(runs.failed, 1);
    }
  }
}

// Contacts are switched while memory runs out: there is no solution, or the right one.
TEST_F(FailingAllocations, Switching) {
  const Scene& scene = file.scene;
  std::vector<char> fewer(scene.contacts.size(), 1);
  for (std::size_t c = 0; c < fewer.size(); c += 2) fewer[c] = 0;
  const VectorXd x = VectorXd::Ones(scene.nv), u = VectorXd::Ones(scene.nu);
  for (const Options& options : {Options{}, Options{Method::kDenseSchur, {}}}) {
    SceneData expected(scene, options);
    expected.active = fewer;
    solve_at(expected);
    std::optional<SceneData> data(std::in_place, scene, options);
    const auto before = [&] {  // derivatives are stored with their islands
      solve_at(*data);
      differentiate(scene, *data);
    };
    before();
    const auto switch_and_solve = [&] {
      data->active = fewer;
      solve_at(*data);
      differentiate(scene, *data);
      VectorXd da(scene.nv), df(data->f.size());
      jvp(scene, *data, x, x, u, da, df);
    };
    const FailedRuns runs = fail_each_allocation(
        switch_and_solve,
        [&] {
          switch_and_solve();
          EXPECT_TRUE(data->a == expected.a);
          EXPECT_TRUE(data->f == expected.f);
          data.emplace(scene, options);
          before();
        },
        true);
    EXPECT_GT(runs.failed, 10);
  }
}

}  // namespace
}  // namespace manycontact::test
