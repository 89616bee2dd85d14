// CHOLMOD's two factorizations against LDL and against dense matrices.

#include "manycontact/sparse/cholmod.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>

#include "manycontact/sparse/ldl.hpp"
#include "sparse/symmetric.hpp"
#include "spatial/compare.hpp"

namespace manycontact::test {
namespace {

using sparse::Cholmod;
using sparse::CholmodKind;

// [H G^T; G -C]: both signs among the pivots.
Eigen::MatrixXd quasi_definite(int n, int m, std::mt19937& rng) {
  Eigen::MatrixXd K(n + m, n + m);
  K.topLeftCorner(n, n) = random_positive(n, 0.2, rng);
  K.bottomRightCorner(m, m) = -random_positive(m, 0.2, rng);
  K.bottomLeftCorner(m, n) = random_symmetric(std::max(n, m), 0.2, rng).topLeftCorner(m, n);
  K.topRightCorner(n, m) = K.bottomLeftCorner(m, n).transpose();
  return K;
}

TEST(Cholmod, SimplicialEqualsLdl) {
  std::mt19937 rng(1);
  const Symmetric A(quasi_definite(25, 15, rng));
  const sparse::LdlSymbolic symbolic = sparse::ldl_analyze(A.pattern);
  sparse::LdlWorkspace work;
  std::vector<double> L(symbolic.nonzeros()), D(A.n()), scale(A.n());
  ASSERT_EQ(sparse::ldl_factor(A.pattern, symbolic, A.x.data(), work, L.data(), D.data()), A.n());

  Cholmod cholmod(A.pattern, CholmodKind::kSimplicialLdl, false);
  for (int again = 0; again < 2; ++again) {
    ASSERT_TRUE(cholmod.factorize(A.x.data()));
    std::vector<double> pivots(A.n());
    cholmod.pivots(pivots.data());
    for (int k = 0; k < A.n(); ++k) EXPECT_LE(std::abs(pivots[k] / D[k] - 1), 64 * kEps) << k;
    EXPECT_NEAR(cholmod.smallest_pivot_ratio(A.x.data(), scale.data()),
                sparse::smallest_pivot_ratio(A.pattern, symbolic, A.x.data(), L.data(), D.data(), scale.data()),
                64 * kEps);
    const Eigen::VectorXd b = random_matrix(A.n(), 1, rng);
    Eigen::VectorXd x = b, y = b;
    cholmod.solve(x.data(), 1);
    sparse::ldl_solve(symbolic, L.data(), D.data(), y.data());
    EXPECT_LE(error_of(x, y), 64 * kEps);
  }
  EXPECT_EQ(cholmod.factor_nonzeros(), symbolic.nonzeros() + A.n());
}

TEST(Cholmod, SimplicialReportsAZeroPivot) {
  const Symmetric A(Eigen::Matrix3d{{1, 2, 1}, {2, 4, 3}, {1, 3, 7}});
  Cholmod cholmod(A.pattern, CholmodKind::kSimplicialLdl, false);
  EXPECT_FALSE(cholmod.factorize(A.x.data()));
  std::vector<double> good = A.x;
  good[A.pattern.slot(1, 1)] = 9;
  EXPECT_TRUE(cholmod.factorize(good.data())) << "a failure must not stay";
}

TEST(Cholmod, SimplicialPivotRatioOfANearlyDependentSystem) {
  const Symmetric A(Eigen::Matrix2d{{1, 1}, {1, 1 + 1e-10}});
  Cholmod cholmod(A.pattern, CholmodKind::kSimplicialLdl, false);
  ASSERT_TRUE(cholmod.factorize(A.x.data()));
  double scale[2];
  EXPECT_NEAR(cholmod.smallest_pivot_ratio(A.x.data(), scale), 0.5e-10, 1e-15);
}

TEST(Cholmod, SupernodalEqualsDense) {
  if (!sparse::supernodal_available()) GTEST_SKIP() << "built without the GPL part";
  std::mt19937 rng(2);
  for (double density : {0.03, 0.3, 1.0}) {
    const Symmetric A(random_positive(80, density, rng));
    for (bool order_rows : {false, true}) {
      Cholmod cholmod(A.pattern, CholmodKind::kSupernodalLlt, order_rows);
      ASSERT_TRUE(cholmod.factorize(A.x.data()));
      const Eigen::MatrixXd b = random_matrix(80, 5, rng);
      Eigen::MatrixXd x = b;
      cholmod.solve(x.data(), 5);
      EXPECT_LE(error_of(x, Eigen::MatrixXd(A.dense.llt().solve(b))), 64 * kEps) << density << order_rows;
      EXPECT_GT(cholmod.rcond(), 0.01);
      EXPECT_LE(cholmod.rcond(), 1);
    }
  }
}

TEST(Cholmod, SupernodalRefusesWhatIsNotPositive) {
  if (!sparse::supernodal_available()) GTEST_SKIP() << "built without the GPL part";
  std::mt19937 rng(3);
  const Symmetric A(quasi_definite(25, 15, rng)), B(random_positive(40, 0.2, rng));
  Cholmod indefinite(A.pattern, CholmodKind::kSupernodalLlt, true);
  EXPECT_FALSE(indefinite.factorize(A.x.data()));
  Cholmod positive(B.pattern, CholmodKind::kSupernodalLlt, true);
  EXPECT_TRUE(positive.factorize(B.x.data()));
}

TEST(Cholmod, SupernodalIsRefusedWhereItIsNotBuiltIn) {
  if (sparse::supernodal_available()) GTEST_SKIP() << "built with the GPL part";
  const Symmetric A(Eigen::MatrixXd::Identity(2, 2));
  EXPECT_THROW(Cholmod(A.pattern, CholmodKind::kSupernodalLlt, true), std::invalid_argument);
}

TEST(Cholmod, MovesAndSolvesSeveralColumns) {
  std::mt19937 rng(4);
  const Symmetric A(quasi_definite(10, 5, rng));
  Cholmod first(A.pattern, CholmodKind::kSimplicialLdl, true);
  ASSERT_TRUE(first.factorize(A.x.data()));
  Cholmod second = std::move(first);
  const Eigen::MatrixXd truth = random_matrix(15, 7, rng);
  for (int cols : {7, 1, 3}) {  // CHOLMOD keeps the workspace of the call before
    Eigen::MatrixXd x = A.dense * truth.leftCols(cols);
    second.solve(x.data(), cols);
    EXPECT_LE(error_of(x, truth.leftCols(cols)), 200 * kEps) << cols;
  }
}

}  // namespace
}  // namespace manycontact::test
