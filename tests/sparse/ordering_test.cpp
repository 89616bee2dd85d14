// Orderings are tested.

#include "manycontact/sparse/ordering.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "manycontact/sparse/ldl.hpp"
#include "sparse/symmetric.hpp"

namespace manycontact::test {
namespace {

void expect_permutation(std::vector<int> perm, int n) {
  std::sort(perm.begin(), perm.end());
  std::vector<int> all(n);
  std::iota(all.begin(), all.end(), 0);
  EXPECT_EQ(perm, all);
}

TEST(Camd, RespectsConstraints) {
  std::mt19937 rng(1);
  for (int trial = 0; trial < 10; ++trial) {
    const Symmetric A(random_symmetric(40, 0.1, rng));
    std::vector<int> set(40);
    for (int& s : set) s = std::uniform_int_distribution<int>(0, 4)(rng);
    const std::vector<int> perm = sparse::camd_order(A.pattern, set);
    expect_permutation(perm, 40);
    for (int k = 1; k < 40; ++k) EXPECT_LE(set[perm[k - 1]], set[perm[k]]);
  }
}

TEST(Camd, UnconstrainedFindsTheOrderWithoutFill) {
  Eigen::MatrixXd A = Eigen::MatrixXd::Identity(30, 30) * 30;  // an arrow whose dense row is the first
  A.row(0).setOnes();
  A.col(0).setOnes();
  const Symmetric arrow(A);
  const std::vector<int> perm = sparse::camd_order(arrow.pattern, {});
  expect_permutation(perm, 30);
  EXPECT_EQ(sparse::ldl_analyze(sparse::permute(arrow.pattern, sparse::inverse(perm))).nonzeros(), 29);
}

TEST(Camd, Empty) { EXPECT_TRUE(sparse::camd_order(sparse::make_pattern(0, {}), {}).empty()); }

}  // namespace
}  // namespace manycontact::test
