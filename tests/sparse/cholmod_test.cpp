// CHOLMOD's factorization agrees with LDL and with dense matrices.

#include "manycontact/sparse/cholmod.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <thread>

#include "manycontact/sparse/ldl.hpp"
#include "sparse/symmetric.hpp"
#include "spatial/compare.hpp"
#include "support/allocations.hpp"
#include "support/dense.hpp"
#include "support/pivot_ratio.hpp"

namespace manycontact::test {
namespace {

using sparse::Cholmod;

Cholmod cholmod_of(const sparse::UpperCsc& pattern) {
  return Cholmod(std::make_shared<const sparse::CholmodSymbolic>(pattern));
}

// Returns [H G^T; G -C], whose pivots have both signs.
Eigen::MatrixXd quasi_definite(int n, int m, std::mt19937& rng) {
  Eigen::MatrixXd K(n + m, n + m);
  K.topLeftCorner(n, n) = random_positive(n, 0.2, rng);
  K.bottomRightCorner(m, m) = -random_positive(m, 0.2, rng);
  K.bottomLeftCorner(m, n) = random_symmetric(std::max(n, m), 0.2, rng).topLeftCorner(m, n);
  K.topRightCorner(n, m) = K.bottomLeftCorner(m, n).transpose();
  return K;
}

TEST(Cholmod, EqualsLdl) {
  std::mt19937 rng(1);
  const Symmetric A(quasi_definite(25, 15, rng));
  const sparse::LdlSymbolic symbolic = sparse::ldl_analyze(A.pattern);
  sparse::LdlWorkspace work;
  std::vector<double> L(symbolic.nonzeros()), D(A.n()), scale(A.n());
  ASSERT_EQ(sparse::ldl_factor(A.pattern, symbolic, A.x.data(), work, L.data(), D.data()), A.n());

  Cholmod cholmod = cholmod_of(A.pattern);
  for (int again = 0; again < 2; ++again) {
    ASSERT_TRUE(cholmod.factorize(A.x.data()));
    std::vector<double> pivots(A.n());
    cholmod.pivots(pivots.data());
    for (int k = 0; k < A.n(); ++k) EXPECT_LE(std::abs(pivots[k] / D[k] - 1), 64 * kEps) << k;
    std::vector<double> terms(A.n());
    cholmod.pivot_terms(A.x.data(), scale.data());
    sparse::pivot_terms(A.pattern, symbolic, A.x.data(), L.data(), D.data(), terms.data());
    for (int k = 0; k < A.n(); ++k) EXPECT_LE(std::abs(scale[k] / terms[k] - 1), 64 * kEps) << k;
    const Eigen::VectorXd b = random_matrix(A.n(), 1, rng);
    Eigen::VectorXd x = b, y = b;
    cholmod.solve(x.data(), 1);
    sparse::ldl_solve(symbolic, L.data(), D.data(), y.data());
    EXPECT_LE(error_of(x, y), 64 * kEps);
  }
  EXPECT_EQ(cholmod.symbolic().factor_nonzeros(), symbolic.nonzeros() + A.n());
}

TEST(Cholmod, ReportsAZeroPivot) {
  const Symmetric A(Eigen::Matrix3d{{1, 2, 1}, {2, 4, 3}, {1, 3, 7}});
  Cholmod cholmod = cholmod_of(A.pattern);
  EXPECT_FALSE(cholmod.factorize(A.x.data()));
  std::vector<double> good = A.x;
  good[A.pattern.slot(1, 1)] = 9;
  EXPECT_TRUE(cholmod.factorize(good.data())) << "a failure must not stay";
}

TEST(Cholmod, PivotRatioOfANearlyDependentSystem) {
  const Symmetric A(Eigen::Matrix2d{{1, 1}, {1, 1 + 1e-10}});
  Cholmod cholmod = cholmod_of(A.pattern);
  ASSERT_TRUE(cholmod.factorize(A.x.data()));
  double D[2], terms[2];
  cholmod.pivots(D);
  cholmod.pivot_terms(A.x.data(), terms);
  EXPECT_NEAR(smallest_pivot_ratio(2, D, terms), 0.5e-10, 1e-15);
}

// Matrices of one pattern share a symbolic phase; their factors are used alternately and at once.
TEST(CholmodSymbolic, IsSharedByFactorsAndThreads) {
  std::mt19937 rng(6);
  const Symmetric A(random_positive(60, 0.1, rng));
  const auto symbolic = std::make_shared<const sparse::CholmodSymbolic>(A.pattern);
  const Eigen::VectorXd truth = random_matrix(60, 1, rng);
  const auto one_of = [&](double scale) {
    Cholmod cholmod(symbolic);
    double error = 0;
    for (int again = 0; again < 20; ++again) {
      std::vector<double> Ax = A.x;
      for (double& a : Ax) a *= scale;
      if (!cholmod.factorize(Ax.data())) return 1.0;
      Eigen::VectorXd x = scale * (A.dense * truth);
      cholmod.solve(x.data(), 1);
      error = std::max(error, error_of(x, truth));
    }
    return error;
  };
  std::vector<double> errors(4, 1);
  std::vector<std::thread> threads;
  for (int t = 0; t < 4; ++t) threads.emplace_back([&, t] { errors[t] = one_of(t + 1); });
  for (std::thread& t : threads) t.join();
  for (double error : errors) EXPECT_LE(error, 64 * kEps);

  Cholmod first(symbolic), second(symbolic);
  std::vector<double> twice = A.x;
  for (double& a : twice) a *= 2;
  ASSERT_TRUE(first.factorize(A.x.data()));
  ASSERT_TRUE(second.factorize(twice.data()));
  Eigen::VectorXd x = A.dense * truth, y = x;
  first.solve(x.data(), 1);
  second.solve(y.data(), 1);
  EXPECT_LE(error_of(x, truth), 64 * kEps) << "the other's factor was used";
  EXPECT_LE(error_of(y, Eigen::VectorXd(0.5 * truth)), 64 * kEps);
  EXPECT_EQ(first.symbolic().factor_nonzeros(), symbolic->factor_nonzeros());
}

// The test checks the header's statements on memory.
TEST(Cholmod, AllocatesNothingAfterItsConstruction) {
  if (!MANYCONTACT_COUNTS_ALLOCATIONS) GTEST_SKIP() << "allocations are not counted in this build";
  std::mt19937 rng(7);
  const Symmetric A(quasi_definite(60, 30, rng));
  Eigen::MatrixXd x = random_matrix(90, 13, rng);
  Cholmod cholmod = cholmod_of(A.pattern);
  bool done = true;
  for (int again = 0; again < 3; ++again) {
    EXPECT_EQ(allocations([&] { done = done && cholmod.factorize(A.x.data()); }), 0u);
    for (int cols : {1, 3, 4, 5, 13, 1, 0})
      EXPECT_EQ(allocations([&] { cholmod.solve(x.data(), cols); }), 0u) << cols << " columns";
  }
  EXPECT_TRUE(done);
}

// There are more columns than are solved at once.
TEST(Cholmod, SolvesForManyColumns) {
  std::mt19937 rng(9);
  const Symmetric A(random_positive(30, 0.2, rng));
  const Eigen::MatrixXd truth = random_matrix(30, 150, rng), b = A.dense * truth;
  Cholmod cholmod = cholmod_of(A.pattern);
  ASSERT_TRUE(cholmod.factorize(A.x.data()));
  for (int cols : {1, 2, 4, 5, 63, 64, 65, 128, 150, 3}) {
    Eigen::MatrixXd x = b;
    cholmod.solve(x.data(), cols);
    EXPECT_LE(error_of(x.leftCols(cols), truth.leftCols(cols)), 64 * kEps) << cols;
    EXPECT_EQ(x.rightCols(150 - cols), b.rightCols(150 - cols)) << cols;
  }
}

TEST(Cholmod, OfNoRows) {
  const sparse::UpperCsc none = sparse::make_pattern(0, {});
  Cholmod cholmod = cholmod_of(none);
  EXPECT_TRUE(cholmod.factorize(nullptr));
  cholmod.solve(nullptr, 3);
  EXPECT_EQ(cholmod.symbolic().factor_nonzeros(), 0);
}

TEST(Cholmod, MovesAndSolvesSeveralColumns) {
  std::mt19937 rng(4);
  const Symmetric A(quasi_definite(10, 5, rng));
  Cholmod first = cholmod_of(A.pattern);
  ASSERT_TRUE(first.factorize(A.x.data()));
  Cholmod second = std::move(first);
  const Eigen::MatrixXd truth = random_matrix(15, 7, rng);
  for (int cols : {7, 1, 3, 4}) {  // four at a time
    Eigen::MatrixXd x = A.dense * truth.leftCols(cols);
    second.solve(x.data(), cols);
    EXPECT_LE(error_of(x, truth.leftCols(cols)), 200 * kEps) << cols;
  }
}

}  // namespace
}  // namespace manycontact::test
