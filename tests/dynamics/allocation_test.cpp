// After the first solve there are no heap allocations, and every thread computes the same bits every time.

#include <gtest/gtest.h>

#include <thread>

#include "manycontact/dynamics/differentiate.hpp"
#include "manycontact/dynamics/solve.hpp"
#include "manycontact/dynamics/views.hpp"
#include "support/allocations.hpp"
#include "support/methods.hpp"
#include "support/scenes.hpp"

namespace manycontact::test {
namespace {

class Steady : public testing::TestWithParam<std::string> {
 protected:
  void SetUp() override {
    file_ = load_scene(GetParam());
    std::mt19937 rng(13);
    disturb(file_, rng);
  }

  void solve_into(SceneData& data) const { (void)solve(file_.scene, file_.q, file_.v, file_.u, data); }

  SceneFile file_;
};

TEST_P(Steady, SparseMethodsAllocateNothing) {
  if (!MANYCONTACT_COUNTS_ALLOCATIONS) GTEST_SKIP() << "malloc cannot be counted here";
  SceneData oracle(file_.scene, {Method::kDense, {}});
  solve_into(oracle);
  for (const Way& way : ways_here()) {
    SceneData data(file_.scene, way.options);
    if (way.options.method == Method::kDenseSchur) continue;
    SCOPED_TRACE(way.name);
    solve_into(data);
    const SceneFile before = file_;
    std::mt19937 rng(14);
    for (int again = 0; again < 3; ++again) {
      disturb(file_, rng);  // other numbers, the same contacts
      EXPECT_EQ(allocations([&] { solve_into(data); }), 0u);
      EXPECT_EQ(data.report.status, oracle.report.status);
    }
    file_ = before;
  }
}

TEST_P(Steady, TheSameBitsTwice) {
  for (const Way& way : ways(true)) {
    SCOPED_TRACE(way.name);
    SceneData data(file_.scene, way.options);
    solve_into(data);
    if (data.report.status == Status::kFailed) continue;
    const Eigen::VectorXd a = data.a, f = data.f;
    solve_into(data);
    EXPECT_TRUE(a == data.a);
    EXPECT_TRUE(f == data.f);
    SceneData fresh(file_.scene, way.options);
    solve_into(fresh);
    EXPECT_TRUE(a == fresh.a);
    EXPECT_TRUE(f == fresh.f);
  }
}

// All threads share one constant scene; each has its own data.
TEST_P(Steady, TheSameBitsOnEveryThread) {
  for (const Way& way : ways(true)) {
    if (way.options.method == Method::kDense || way.options.method == Method::kDenseSchur) continue;
    SCOPED_TRACE(way.name);
    SceneData alone(file_.scene, way.options);
    solve_into(alone);
    std::vector<SceneData> data;
    for (int k = 0; k < 2; ++k) data.emplace_back(file_.scene, way.options);
    std::vector<std::thread> threads;
    for (SceneData& d : data)
      threads.emplace_back([this, &d] {
        for (int again = 0; again < 5; ++again) solve_into(d);
      });
    for (std::thread& thread : threads) thread.join();
    for (const SceneData& d : data) {
      EXPECT_TRUE(alone.a == d.a);
      EXPECT_TRUE(alone.f == d.f);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Models, Steady, testing::ValuesIn(model_scenes()), scene_title);

// Memory of derivatives, dense-schur's inverse too, is released and allocated again.
TEST(Released, DerivativesLeaveNothingBehind) {
  if (!MANYCONTACT_COUNTS_ALLOCATIONS) GTEST_SKIP() << "malloc cannot be counted here";
  for (const char* name : {"humanoid_standing", "feet_on_corners", "herd"}) {
    const SceneFile file = load_small(std::string(MANYCONTACT_SOURCE_DIR "/models/") + name + ".xml");
    const Scene& scene = file.scene;
    for (const Way& way : ways(true)) {
      SCOPED_TRACE(std::string(name) + ", " + way.name);
      SceneData data(scene, way.options);
      const auto solved = [&] { return solve(scene, file.q, file.v, file.u, data).status != Status::kFailed; };
      if (!solved()) continue;
      (void)differentiate(scene, data);
      release_derivatives(data);
      ASSERT_TRUE(solved());
      const std::ptrdiff_t without = blocks_held();
      (void)differentiate(scene, data);
      const Eigen::MatrixXd da_dq = dense_derivatives(scene, data).da_dq;
      EXPECT_GT(blocks_held(), without + 1);  // the matrix above is one block
      release_derivatives(data);
      EXPECT_EQ(blocks_held(), without + 1);
      EXPECT_THROW((void)derivatives(data), std::logic_error);
      (void)differentiate(scene, data);
      EXPECT_TRUE(dense_derivatives(scene, data).da_dq == da_dq);
    }
  }
}

// The counter counts allocations of Eigen and of the standard library.
TEST(Allocations, AreCounted) {
  if (!MANYCONTACT_COUNTS_ALLOCATIONS) GTEST_SKIP() << "malloc cannot be counted here";
  static Eigen::VectorXd of_eigen;  // so that compilers may not omit it
  static std::vector<int> x, y;
  EXPECT_GE(allocations([] { of_eigen = Eigen::VectorXd::Zero(100); }), 1u);
  EXPECT_GE(allocations([] { x.resize(100), y = x; }), 2u);
}

}  // namespace
}  // namespace manycontact::test
