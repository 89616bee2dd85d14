// Patterns, permutations and products of symmetric matrices agree with dense ones.

#include "manycontact/sparse/upper_csc.hpp"

#include <gtest/gtest.h>

#include <numeric>

#include "manycontact/sparse/ordering.hpp"
#include "manycontact/sparse/panel_kernels.hpp"
#include "sparse/symmetric.hpp"
#include "spatial/compare.hpp"

namespace manycontact::test {
namespace {

TEST(UpperCsc, MakePatternTakesAnyOrderTriangleAndRepetition) {
  const sparse::UpperCsc A = sparse::make_pattern(4, {{3, 0}, {0, 3}, {1, 2}, {2, 1}, {0, 0}, {0, 3}});
  EXPECT_EQ(A.n, 4);
  EXPECT_EQ(A.p, (std::vector<int>{0, 1, 2, 4, 6}));
  EXPECT_EQ(A.i, (std::vector<int>{0, 1, 1, 2, 0, 3}));
  EXPECT_EQ(A.nonzeros(), 6);
}

TEST(UpperCsc, MakePatternOfNothing) {
  const sparse::UpperCsc A = sparse::make_pattern(0, {});
  EXPECT_EQ(A.n, 0);
  EXPECT_EQ(A.p, std::vector<int>{0});
  EXPECT_EQ(A.nonzeros(), 0);
}

TEST(UpperCsc, SlotFindsEveryEntryAndNoOther) {
  std::mt19937 rng(1);
  const Symmetric A(random_symmetric(20, 0.3, rng));
  for (int j = 0; j < A.n(); ++j)
    for (int i = 0; i <= j; ++i) {
      const int slot = A.pattern.slot(i, j);
      ASSERT_EQ(slot >= 0, A.dense(i, j) != 0 || i == j) << i << ' ' << j;
      if (slot >= 0) {
        EXPECT_EQ(A.x[slot], A.dense(i, j)) << i << ' ' << j;
      }
    }
}

TEST(UpperCsc, PermuteMovesEntries) {
  std::mt19937 rng(2);
  const Symmetric A(random_symmetric(15, 0.3, rng));
  std::vector<int> perm(A.n());
  std::iota(perm.begin(), perm.end(), 0);
  std::shuffle(perm.begin(), perm.end(), rng);
  const std::vector<int> iperm = sparse::inverse(perm);
  for (int k = 0; k < A.n(); ++k) EXPECT_EQ(iperm[perm[k]], k);

  Eigen::MatrixXd moved(A.n(), A.n());
  for (int i = 0; i < A.n(); ++i)
    for (int j = 0; j < A.n(); ++j) moved(iperm[i], iperm[j]) = A.dense(i, j);
  const sparse::UpperCsc expected = Symmetric(moved).pattern, actual = sparse::permute(A.pattern, iperm);
  EXPECT_EQ(actual.p, expected.p);
  EXPECT_EQ(actual.i, expected.i);
}

TEST(UpperCsc, ResidualAndItsScale) {
  std::mt19937 rng(3);
  const Symmetric A(random_symmetric(30, 0.2, rng));
  const Eigen::VectorXd x = random_matrix(30, 1, rng), b = random_matrix(30, 1, rng);
  Eigen::VectorXd r = Eigen::VectorXd::Constant(30, NAN), scale = r;
  sparse::residual(A.pattern, A.x.data(), x.data(), b.data(), r.data(), scale.data());
  EXPECT_LE(error_of(r, Eigen::VectorXd(b - A.dense * x)), 8 * kEps);
  EXPECT_LE(error_of(scale, Eigen::VectorXd(b.cwiseAbs() + A.dense.cwiseAbs() * x.cwiseAbs())), 8 * kEps);
}

// Entries are scattered, or rows follow each other: sums of n products are each rounded once or twice.
TEST(UpperCsc, ResidualOfEveryLevel) {
  std::mt19937 rng(5);
  const int n = 37;
  for (const double density : {0.0, 0.1, 0.7, 1.0}) {
    const Symmetric A(random_symmetric(n, density, rng));
    const Eigen::VectorXd x = random_matrix(n, 1, rng), b = random_matrix(n, 1, rng);
    const Eigen::VectorXd size = b.cwiseAbs() + A.dense.cwiseAbs() * x.cwiseAbs();
    for (const sparse::PanelKernels* level : sparse::panel_levels()) {
      SCOPED_TRACE(level->name);
      Eigen::VectorXd r = Eigen::VectorXd::Constant(n, NAN), scale = r;
      level->residual_vector(A.pattern, A.x.data(), x.data(), b.data(), r.data(), scale.data());
      EXPECT_LE(((r - (b - A.dense * x)).cwiseAbs().array() / size.array()).maxCoeff(), 2 * n * kEps);
      EXPECT_LE(((scale - size).cwiseAbs().array() / size.array()).maxCoeff(), 2 * n * kEps);
    }
  }
}

TEST(UpperCsc, Norm1CountsBothTriangles) {
  std::mt19937 rng(4);
  for (int trial = 0; trial < 10; ++trial) {
    const Symmetric A(random_symmetric(30, 0.2, rng));
    Eigen::VectorXd work = Eigen::VectorXd::Constant(30, NAN);
    const double truth = A.dense.cwiseAbs().colwise().sum().maxCoeff();
    EXPECT_NEAR(sparse::norm_1(A.pattern, A.x.data(), work.data()), truth, 8 * kEps * truth);
  }
  EXPECT_EQ(sparse::norm_1(sparse::make_pattern(0, {}), nullptr, nullptr), 0);
}

}  // namespace
}  // namespace manycontact::test
