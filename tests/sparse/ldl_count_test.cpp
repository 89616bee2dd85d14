// Sizes of L are computed without L, and agree with the factor's pattern.

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>

#include "manycontact/sparse/ldl.hpp"
#include "manycontact/sparse/relaxed_supernodes.hpp"

namespace manycontact::test {
namespace {

void expect_counts(const sparse::UpperCsc& A) {
  const sparse::LdlSymbolic L = sparse::ldl_analyze(A);
  const sparse::LdlCounts counts = sparse::ldl_count(A);
  EXPECT_EQ(counts.nonzeros, L.nonzeros());
  EXPECT_EQ(counts.flops, L.flops);
  sparse::LdlSymbolic relaxed = L;
  sparse::relax_supernodes(relaxed);
  double blocks = 0, scattered = 0;
  for (int k = 0; k < L.n; ++k)
    if (const double below = relaxed.Lp[k + 1] - relaxed.Lp[k]; !relaxed.nests(k)) ++blocks, scattered += below * below;
  EXPECT_EQ(counts.blocks, blocks);
  EXPECT_EQ(counts.scattered, scattered);
}

TEST(LdlCount, RandomPatterns) {
  std::mt19937 rng(5);
  for (int n : {1, 2, 7, 40, 150})
    for (int entries : {0, 1, n / 2, n, 3 * n, n * n / 3}) {
      std::vector<std::pair<int, int>> list;
      for (int k = 0; k < entries; ++k) list.emplace_back(rng() % n, rng() % n);
      SCOPED_TRACE(std::to_string(n) + " rows, " + std::to_string(entries) + " entries");
      expect_counts(sparse::make_pattern(n, list));
    }
}

TEST(LdlCount, ArrowsOfBothDirections) {
  constexpr int n = 9;
  std::vector<std::pair<int, int>> down, up;
  for (int k = 0; k < n; ++k) down.emplace_back(k, n - 1), up.emplace_back(0, k);
  expect_counts(sparse::make_pattern(n, down));
  expect_counts(sparse::make_pattern(n, up));
  EXPECT_EQ(sparse::ldl_count(sparse::make_pattern(n, down)).nonzeros, n - 1);
  EXPECT_EQ(sparse::ldl_count(sparse::make_pattern(n, up)).nonzeros, n * (n - 1) / 2);
}

TEST(LdlCount, NothingOfNothing) {
  EXPECT_EQ(sparse::ldl_count(sparse::make_pattern(0, {})).nonzeros, 0);
  EXPECT_EQ(sparse::ldl_count(sparse::make_pattern(4, {})).flops, 0);
}

}  // namespace
}  // namespace manycontact::test
