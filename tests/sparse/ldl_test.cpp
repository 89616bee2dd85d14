// L D L^T agrees with the dense matrix, in one test per structure.

#include "manycontact/sparse/ldl.hpp"

#include <gtest/gtest.h>

#include "sparse/symmetric.hpp"
#include "spatial/compare.hpp"
#include "support/allocations.hpp"
#include "support/dense.hpp"
#include "support/pivot_ratio.hpp"

namespace manycontact::test {
namespace {

struct LdlFactor {
  sparse::LdlSymbolic symbolic;
  sparse::LdlWorkspace work;
  std::vector<double> L, D;
  int done = -1;  // return value of ldl_factor

  explicit LdlFactor(const Symmetric& A) : symbolic(sparse::ldl_analyze(A.pattern)) {
    L.assign(symbolic.nonzeros(), NAN);
    D.assign(A.n(), NAN);
    done = sparse::ldl_factor(A.pattern, symbolic, A.x.data(), work, L.data(), D.data());
  }
  Eigen::MatrixXd dense_L() const {
    Eigen::MatrixXd dense = Eigen::MatrixXd::Identity(symbolic.n, symbolic.n);
    for (int j = 0; j < symbolic.n; ++j)
      for (int k = symbolic.Lp[j]; k < symbolic.Lp[j + 1]; ++k) dense(symbolic.Li[k], j) = L[k];
    return dense;
  }
  Eigen::VectorXd pivots() const { return Eigen::Map<const Eigen::VectorXd>(D.data(), symbolic.n); }
  int positive() const { return static_cast<int>((pivots().array() > 0).count()); }
  double pivot_ratio(const Symmetric& A) const {
    std::vector<double> scale(A.n(), NAN);
    sparse::pivot_terms(A.pattern, symbolic, A.x.data(), L.data(), D.data(), scale.data());
    return smallest_pivot_ratio(A.n(), D.data(), scale.data());
  }
};

// Expects A = L D L^T, and x = A^-1 b with the error that the condition allows.
void expect_factorizes(const Symmetric& A, std::mt19937& rng) {
  const LdlFactor f(A);
  ASSERT_EQ(f.done, A.n());
  const Eigen::MatrixXd L = f.dense_L();
  const Eigen::MatrixXd LD = L * f.pivots().asDiagonal();
  const double growth = size_of(Eigen::MatrixXd(LD.cwiseAbs() * L.transpose().cwiseAbs()));
  EXPECT_LE(difference_of(Eigen::MatrixXd(LD * L.transpose()), A.dense), 8 * kEps * growth);
  for (int j = 0; j < A.n(); ++j) {
    const auto rows = f.symbolic.Li.begin();
    EXPECT_TRUE(std::is_sorted(rows + f.symbolic.Lp[j], rows + f.symbolic.Lp[j + 1]));
  }
  const Eigen::VectorXd truth = random_matrix(A.n(), 1, rng);
  Eigen::VectorXd x = A.dense * truth;
  sparse::ldl_solve(f.symbolic, f.L.data(), f.D.data(), x.data());
  EXPECT_LE(error_of(x, truth), 4 * kEps * condition_1(A.dense));
}

TEST(Ldl, DenseArrowFillsNothing) {
  std::mt19937 rng(1);
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(12, 12);
  A.diagonal().setConstant(20);
  A.row(11).head(11) = random_matrix(1, 11, rng);
  A.col(11).head(11) = A.row(11).head(11);
  const Symmetric arrow(A);
  expect_factorizes(arrow, rng);
  EXPECT_EQ(LdlFactor(arrow).symbolic.nonzeros(), 11);
}

TEST(Ldl, ArrowTheWrongWayRoundFillsAll) {
  std::mt19937 rng(2);
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(12, 12);
  A.diagonal().setConstant(20);
  A.row(0).tail(11) = random_matrix(1, 11, rng);
  A.col(0).tail(11) = A.row(0).tail(11);
  const Symmetric arrow(A);
  expect_factorizes(arrow, rng);
  const LdlFactor f(arrow);
  EXPECT_EQ(f.symbolic.nonzeros(), 66);
  double flops = 0;
  for (int count = 0; count < 12; ++count) flops += count * (count + 2);
  EXPECT_EQ(f.symbolic.flops, flops);
}

TEST(Ldl, Banded) {
  std::mt19937 rng(3);
  Eigen::MatrixXd A = random_positive(40, 1, rng);
  for (int j = 0; j < 40; ++j)
    for (int i = 0; i < 40; ++i)
      if (std::abs(i - j) > 3) A(i, j) = 0;
  const Symmetric band(A);
  expect_factorizes(band, rng);
  EXPECT_EQ(LdlFactor(band).symbolic.nonzeros(), 3 * 40 - 6);
}

TEST(Ldl, Diagonal) {
  std::mt19937 rng(4);
  const Symmetric A(Eigen::VectorXd(random_matrix(10, 1, rng)).asDiagonal());
  expect_factorizes(A, rng);
  const LdlFactor f(A);
  EXPECT_EQ(f.symbolic.nonzeros(), 0);
  EXPECT_EQ(f.pivots(), A.dense.diagonal());
  EXPECT_EQ(f.pivot_ratio(A), 1);
}

TEST(Ldl, RandomPositiveDefinite) {
  std::mt19937 rng(5);
  for (double density : {0.02, 0.1, 0.5}) expect_factorizes(Symmetric(random_positive(60, density, rng)), rng);
}

// [H G^T; G -C] with H, C positive definite is in a random order: every order has pivots.
TEST(Ldl, QuasiDefiniteInAnyOrderHasTheInertiaOfItsBlocks) {
  std::mt19937 rng(6);
  const int n = 14, m = 9;
  Eigen::MatrixXd K(n + m, n + m);
  K.topLeftCorner(n, n) = random_positive(n, 0.3, rng);
  K.bottomRightCorner(m, m) = -random_positive(m, 0.3, rng);
  K.bottomLeftCorner(m, n) = random_matrix(m, n, rng);
  K.topRightCorner(n, m) = K.bottomLeftCorner(m, n).transpose();
  for (int trial = 0; trial < 5; ++trial) {
    Eigen::PermutationMatrix<Eigen::Dynamic> P(n + m);
    P.setIdentity();
    std::shuffle(P.indices().begin(), P.indices().end(), rng);
    const Symmetric A(P * K * P.transpose());
    expect_factorizes(A, rng);
    EXPECT_EQ(LdlFactor(A).positive(), n);
  }
}

TEST(Ldl, PivotSignsAreTheInertia) {
  std::mt19937 rng(7);
  for (int trial = 0; trial < 5; ++trial) {
    const Symmetric A(random_symmetric(12, 0.6, rng));
    const Eigen::VectorXd lambda = eigenvalues(A.dense);
    const LdlFactor f(A);
    ASSERT_EQ(f.done, 12);
    EXPECT_EQ(f.positive(), (lambda.array() > 0).count());
  }
}

// Small integers make the pivot exactly zero.
TEST(Ldl, ZeroPivotFirst) { EXPECT_EQ(LdlFactor(Symmetric(Eigen::Matrix3d{{0, 1, 2}, {1, 4, 0}, {2, 0, 5}})).done, 0); }

TEST(Ldl, ZeroPivotInTheMiddle) {
  EXPECT_EQ(LdlFactor(Symmetric(Eigen::Matrix3d{{1, 2, 1}, {2, 4, 3}, {1, 3, 7}})).done, 1);
}

TEST(Ldl, ZeroPivotLast) { EXPECT_EQ(LdlFactor(Symmetric(Eigen::Matrix3d{{1, 2, 0}, {2, 5, 1}, {0, 1, 1}})).done, 2); }

TEST(Ldl, ZeroPivotDoesNotSpoilTheWorkspace) {
  const Symmetric bad(Eigen::Matrix3d{{1, 2, 1}, {2, 4, 3}, {1, 3, 7}});
  LdlFactor f(bad);
  std::vector<double> good = bad.x;
  good[bad.pattern.slot(1, 1)] = 9;
  ASSERT_EQ(sparse::ldl_factor(bad.pattern, f.symbolic, good.data(), f.work, f.L.data(), f.D.data()), 3);
  const Eigen::Matrix3d LDL = f.dense_L() * f.pivots().asDiagonal() * f.dense_L().transpose();
  EXPECT_LE(difference_of(LDL, Eigen::Matrix3d{{1, 2, 1}, {2, 9, 3}, {1, 3, 7}}), 16 * kEps);
}

// The rank is 7 of 10: three pivots are rounding error, which the ratio shows (or exactly zero, and it stops).
TEST(Ldl, RankDeficientShowsInThePivotRatio) {
  std::mt19937 rng(8);
  for (int trial = 0; trial < 10; ++trial) {
    const Eigen::MatrixXd B = random_matrix(10, 7, rng);
    const Symmetric A(Eigen::MatrixXd(B * B.transpose()));
    const LdlFactor f(A);
    if (f.done == 10) {
      EXPECT_LE(f.pivot_ratio(A), 100 * kEps);
    }
  }
}

TEST(Ldl, PivotRatioOfANearlyDependentSystem) {
  for (double gap : {1e-3, 1e-6, 1e-9, 1e-12}) {
    const Symmetric A(Eigen::Matrix2d{{1, 1}, {1, 1 + gap}});
    EXPECT_NEAR(LdlFactor(A).pivot_ratio(A) / (gap / (2 + gap)), 1, 2 * kEps / gap);
  }
  const Symmetric A(Eigen::Matrix2d{{4, 2}, {2, -3}});  // no cancellation: D = 4, -4 of terms 3 + 1
  EXPECT_EQ(LdlFactor(A).pivot_ratio(A), 1);
}

TEST(Ldl, PivotRatioIsZeroForWhatIsNotANumber) {
  EXPECT_EQ(LdlFactor(Symmetric(Eigen::Matrix2d{{1, NAN}, {NAN, 1}}))
                .pivot_ratio(Symmetric(Eigen::Matrix2d{{1, NAN}, {NAN, 1}})),
            0);
}

TEST(Ldl, OneByOne) {
  const Symmetric A(Eigen::MatrixXd::Constant(1, 1, -4));
  const LdlFactor f(A);
  ASSERT_EQ(f.done, 1);
  double x = 6;
  sparse::ldl_solve(f.symbolic, f.L.data(), f.D.data(), &x);
  EXPECT_EQ(x, -1.5);
}

TEST(Ldl, Empty) {
  const Symmetric A(Eigen::MatrixXd(0, 0));
  const LdlFactor f(A);
  EXPECT_EQ(f.done, 0);
  EXPECT_EQ(f.symbolic.nonzeros(), 0);
  sparse::ldl_solve(f.symbolic, nullptr, nullptr, nullptr);
}

TEST(Ldl, AllocatesNothingAfterTheFirstCall) {
  if (!MANYCONTACT_COUNTS_ALLOCATIONS) GTEST_SKIP() << "malloc is not ours to count";
  ASSERT_GT(allocations([] { Eigen::VectorXd::Ones(100).eval(); }), 0u) << "the counter does not count";
  std::mt19937 rng(9);
  const Symmetric A(random_positive(60, 0.1, rng));
  LdlFactor f(A);
  Eigen::VectorXd x = random_matrix(60, 1, rng), scale(60), r(60), b = x;
  const auto count = allocations([&] {
    f.done = sparse::ldl_factor(A.pattern, f.symbolic, A.x.data(), f.work, f.L.data(), f.D.data());
    sparse::ldl_solve(f.symbolic, f.L.data(), f.D.data(), x.data());
    sparse::residual(A.pattern, A.x.data(), x.data(), b.data(), r.data(), scale.data());
    sparse::pivot_terms(A.pattern, f.symbolic, A.x.data(), f.L.data(), f.D.data(), scale.data());
    sparse::norm_1(A.pattern, A.x.data(), scale.data());
  });
  EXPECT_EQ(count, 0u);
}

}  // namespace
}  // namespace manycontact::test
