#include "manycontact/lq/plan.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "random_problem.hpp"

namespace manycontact::test {
namespace {

using Lists = std::vector<std::vector<int>>;

// Returns the clusters of a knot, blocks and clusters sorted.
Lists clusters(const std::vector<lq::Cluster>& knot) {
  Lists out;
  for (const lq::Cluster& c : knot) {
    out.push_back(c.blocks);
    std::sort(out.back().begin(), out.back().end());
  }
  std::sort(out.begin(), out.end());
  return out;
}

class LqPlan : public testing::Test {
 protected:
  // Blocks 0 and 2 are a group in knots 3 and 4, blocks 1 and 3 have a coupling in knot 6; the horizon is 8.
  LqPlan() {
    LqOptions options;
    options.horizon = 8;
    options.groups = [](int k) { return k == 3 || k == 4 ? Lists{{2, 0}} : Lists{}; };
    options.couplings = [](int k) { return k == 6 ? Lists{{1, 3}} : Lists{}; };
    problem = random_lq(rng, options);
  }
  std::mt19937 rng{2};
  lq::Problem problem;
};

TEST_F(LqPlan, IslandsAreWhatIsJoinedInAKnotOrLater) {
  const lq::Plan plan = lq::make_plan(problem, lq::Join::kIslands);
  for (int k = 0; k <= 8; ++k) {
    const Lists expected = k > 6 ? Lists{{0}, {1}, {2}, {3}} : k > 4 ? Lists{{0}, {1, 3}, {2}} : Lists{{0, 2}, {1, 3}};
    EXPECT_EQ(clusters(plan[k]), expected) << "knot " << k;
  }
}

TEST_F(LqPlan, WithoutCouplingsClustersAreThoseOfAllKnots) {
  for (const auto& knot : lq::make_plan(problem, lq::Join::kNoCouplings)) {
    EXPECT_EQ(clusters(knot), (Lists{{0, 2}, {1}, {3}}));
    for (const lq::Cluster& c : knot) EXPECT_EQ(c.nv, c.nu);
  }
  for (const auto& knot : lq::make_plan(problem, lq::Join::kAll)) EXPECT_EQ(clusters(knot), (Lists{{0, 1, 2, 3}}));
}

TEST_F(LqPlan, ClustersNameThoseOfTheNextKnotThatTheyAreMadeOf) {
  const lq::Plan plan = lq::make_plan(problem, lq::Join::kIslands);
  for (int k = 0; k < 8; ++k) {
    std::vector<int> all;
    for (const lq::Cluster& c : plan[k]) {
      std::vector<int> blocks;
      for (int d : c.next) blocks.insert(blocks.end(), plan[k + 1][d].blocks.begin(), plan[k + 1][d].blocks.end());
      std::vector<int> sorted = c.blocks;
      std::sort(sorted.begin(), sorted.end());
      std::sort(blocks.begin(), blocks.end());
      EXPECT_EQ(blocks, sorted);
      all.insert(all.end(), c.next.begin(), c.next.end());
    }
    EXPECT_EQ(all.size(), plan[k + 1].size());
  }
}

TEST_F(LqPlan, SeparateBlocksCostWhatTheyCostAlone) {
  LqOptions one, many;
  one.nx = {7};
  one.nu = {3};
  many.nx.assign(50, 7);
  many.nu.assign(50, 3);
  const lq::Problem alone = random_lq(rng, one), herd = random_lq(rng, many);
  const double flops = lq::riccati_flops(alone, lq::make_plan(alone, lq::Join::kIslands));
  EXPECT_DOUBLE_EQ(lq::riccati_flops(herd, lq::make_plan(herd, lq::Join::kIslands)), 50 * flops);
  EXPECT_GT(lq::riccati_flops(herd, lq::make_plan(herd, lq::Join::kAll)), 10000 * flops);
}

}  // namespace
}  // namespace manycontact::test
