// The estimate of a 1-norm from products agrees with norms of explicit matrices.

#include "manycontact/sparse/condition.hpp"

#include <gtest/gtest.h>

#include "sparse/symmetric.hpp"
#include "spatial/compare.hpp"
#include "support/dense.hpp"

namespace manycontact::test {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

double norm_1(const MatrixXd& A) { return A.cwiseAbs().colwise().sum().maxCoeff(); }

double estimate_of(const MatrixXd& B) {
  const int n = static_cast<int>(B.rows());
  const auto multiply = [&, n](const MatrixXd& A, double* x) {
    Eigen::Map<VectorXd> y(x, n);
    y = (A * y).eval();
  };
  const MatrixXd transposed = B.transpose();
  return sparse::norm_1_estimate(
      n, [&](double* x) { multiply(B, x); }, [&](double* x) { multiply(transposed, x); });
}

void expect_lower_bound_within(double factor, const MatrixXd& B) {
  const double truth = norm_1(B), estimate = estimate_of(B);
  EXPECT_LE(estimate, truth * (1 + 1e-12)) << B.rows();
  EXPECT_GE(estimate, truth / factor) << B.rows();
}

TEST(Norm1Estimate, IsALowerBoundWithinAFactorThree) {
  std::mt19937 rng(71);
  for (int trial = 0; trial < 300; ++trial) {
    const int n = 1 + trial % 40;
    expect_lower_bound_within(3, random_matrix(n, n, rng));                // not symmetric
    expect_lower_bound_within(3, random_symmetric(n, 0.2, rng));           // sparse
    expect_lower_bound_within(3, inverse_of(random_matrix(n, n, rng)));    // entries of all sizes
    const VectorXd sizes = (10 * random_matrix(n, 1, rng)).array().exp();  // badly scaled
    expect_lower_bound_within(3, sizes.asDiagonal() * random_matrix(n, n, rng));
    expect_lower_bound_within(3, random_matrix(n, n, rng) * sizes.asDiagonal());
  }
}

// Without negative entries the first gradient is the column sums themselves.
TEST(Norm1Estimate, IsExactForMatricesWithoutNegativeEntries) {
  std::mt19937 rng(72);
  for (int n : {1, 2, 3, 10, 33}) {
    const MatrixXd B = random_matrix(n, n, rng).cwiseAbs();
    EXPECT_NEAR(estimate_of(B), norm_1(B), 8 * kEps * norm_1(B));
    EXPECT_NEAR(estimate_of(-B), norm_1(B), 8 * kEps * norm_1(B));
  }
}

TEST(Norm1Estimate, IsExactForDiagonalAndRankOneMatrices) {
  std::mt19937 rng(73);
  for (int n : {1, 2, 7, 20}) {
    const MatrixXd D = random_matrix(n, 1, rng).asDiagonal();
    EXPECT_NEAR(estimate_of(D), norm_1(D), 8 * kEps * norm_1(D));
    const VectorXd u = random_matrix(n, 1, rng), v = random_matrix(n, 1, rng);
    const MatrixXd B = u * v.transpose();
    EXPECT_NEAR(estimate_of(B), u.cwiseAbs().sum() * v.cwiseAbs().maxCoeff(), 1e-13 * norm_1(B));
  }
}

// The inverse of the tridiagonal (-1, 2, -1) is known: entries min(i, j) (n + 1 - max(i, j)) / (n + 1).
TEST(InverseNorm1, IsExactForTheSecondDifference) {
  for (int n : {1, 2, 5, 50}) {
    MatrixXd A = 2 * MatrixXd::Identity(n, n);
    for (int k = 1; k < n; ++k) A(k, k - 1) = A(k - 1, k) = -1;
    const double estimate = sparse::inverse_norm_1(n, [&](double* x) {
      Eigen::Map<VectorXd> y(x, n);
      y = solved(A, y).col(0);
    });
    const int middle = (n + 1) / 2;
    const double truth = 0.5 * middle * (n + 1 - middle);
    EXPECT_NEAR(estimate, truth, 1e-12 * truth) << n;
  }
}

// Higham's counter-example (1988, sec. 2) is B = I + t u u^T with u orthogonal to the method's three starting vectors:
// the ones, the first unit vector and the alternating one. All numbers are exact, so the estimate misses u.
TEST(Norm1Estimate, MissesWhatIsOrthogonalToItsThreeVectors) {
  const double t = 1024;
  const Eigen::VectorXd alternating{{1, -1.25, 1.5, -1.75, 2}}, u{{0, 1, -14, 1, 12}};
  ASSERT_EQ(u.sum(), 0);
  ASSERT_EQ(u.dot(alternating), 0);
  const MatrixXd B = MatrixXd::Identity(5, 5) + t * u * u.transpose();
  EXPECT_EQ(norm_1(B), 1 + t * 14 * 28);
  EXPECT_NEAR(estimate_of(B), 1, 1e-9);
}

// The alternating vector detects what the other two miss.
TEST(Norm1Estimate, IsSavedByTheAlternatingVector) {
  const double t = 1024;
  const Eigen::VectorXd u{{0, 1, -1, 0, 0}};
  const MatrixXd B = MatrixXd::Identity(5, 5) + t * u * u.transpose();
  EXPECT_EQ(norm_1(B), 1 + 2 * t);
  EXPECT_GE(estimate_of(B), norm_1(B) / 3);
}

// Gradients are compared by magnitude: the largest column may have the opposite sign of the sum of all.
TEST(Norm1Estimate, TakesTheLargestGradientOfEitherSign) {
  const Eigen::Matrix3d B{{10, 10, -15}, {10, 10, -15}, {10, 10, -15}};
  EXPECT_EQ(estimate_of(B), 45);
}

// If every step promises more, five are made, of two products each, plus the alternating vector's.
TEST(Norm1Estimate, TakesElevenProductsAtMost) {
  int products = 0;
  const auto promise = [&](double* x) {
    ++products;
    std::fill(x, x + 30, 0.0);
    x[products] = std::pow(10.0, products);
  };
  EXPECT_GT(sparse::norm_1_estimate(30, promise, promise), 0);
  EXPECT_EQ(products, 11);
}

TEST(InverseNorm1, IsALowerBoundWithinAFactorThree) {
  std::mt19937 rng(2);
  for (int trial = 0; trial < 100; ++trial) {
    const int n = 1 + trial % 30;
    const MatrixXd A = random_symmetric(n, trial % 2 ? 1 : 0.3, rng);
    const MatrixXd inverse = inverse_of(A);
    const double truth = norm_1(inverse);
    const double estimate = sparse::inverse_norm_1(n, [&](double* x) {
      Eigen::Map<VectorXd> y(x, n);
      y = (inverse * y).eval();
    });
    EXPECT_LE(estimate, truth * (1 + 1e-12)) << n;
    EXPECT_GE(estimate, truth / 3) << n;
  }
}

TEST(InverseNorm1, OfNothingAndOfASingularMatrix) {
  EXPECT_EQ(sparse::inverse_norm_1(0, [](double*) { FAIL(); }), 0);
  EXPECT_EQ(sparse::inverse_norm_1(3, [](double* x) { std::fill(x, x + 3, INFINITY); }), INFINITY);
  EXPECT_EQ(sparse::inverse_norm_1(3, [](double* x) { std::fill(x, x + 3, NAN); }), INFINITY);
}

}  // namespace
}  // namespace manycontact::test
