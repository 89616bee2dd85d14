// Least-squares solutions of least norm agree with Eigen's complete orthogonal decomposition.

#include "manycontact/rank/least_norm.hpp"

#include <gtest/gtest.h>

#include "sparse/symmetric.hpp"
#include "spatial/compare.hpp"
#include "support/dense.hpp"

namespace manycontact::test {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

struct Case {
  std::string name;
  MatrixXd A;
};

std::vector<Eigen::Triplet<double>> entries_of(const MatrixXd& A) {
  std::vector<Eigen::Triplet<double>> entries;
  for (int i = 0; i < A.rows(); ++i)
    for (int j = 0; j < A.cols(); ++j)
      if (A(i, j) != 0) {  // in two parts that add up
        entries.emplace_back(i, j, 0.25 * A(i, j));
        entries.emplace_back(i, j, 0.75 * A(i, j));
      }
  return entries;
}

MatrixXd random_sparse(int rows, int cols, double density, std::mt19937& rng) {
  MatrixXd A = random_matrix(rows, cols, rng);
  std::bernoulli_distribution kept(density);
  for (int i = 0; i < rows; ++i)
    for (int j = 0; j < cols; ++j)
      if (!kept(rng)) A(i, j) = 0;
  return A;
}

std::vector<Case> cases() {
  std::mt19937 rng(31);
  std::vector<Case> out;
  out.push_back({"wide", random_sparse(8, 20, 0.4, rng)});
  out.push_back({"tall", random_sparse(20, 8, 0.4, rng)});
  out.push_back({"square", MatrixXd(random_sparse(12, 12, 0.3, rng) + 2 * MatrixXd::Identity(12, 12))});
  out.push_back({"low rank", MatrixXd(random_matrix(10, 3, rng) * random_matrix(3, 14, rng))});
  MatrixXd A = random_sparse(9, 15, 0.4, rng);
  A.row(4) = A.row(1) - 2 * A.row(7);
  out.push_back({"dependent row", A});
  A = random_sparse(9, 15, 0.4, rng);
  A.col(3) = A.col(5);
  A.row(2).setZero();
  A.col(9).setZero();
  out.push_back({"equal columns, zero row, zero column", A});
  A.setZero(14, 18);
  A.topLeftCorner(5, 9) = random_sparse(5, 9, 0.5, rng);
  A.block(5, 9, 9, 5) = random_sparse(9, 5, 0.6, rng);
  out.push_back({"blocks", A});
  A = random_matrix(6, 9, rng);
  A.row(5) = A.row(0) + A.row(1) + 1e-9 * A.row(5);  // neither dependent nor soundly independent
  out.push_back({"nearly dependent row", A});
  out.push_back({"nothing", MatrixXd::Zero(3, 4)});
  return out;
}

TEST(LeastNorm, IsThatOfTheDecomposition) {
  std::mt19937 rng(32);
  for (const Case& c : cases()) {
    SCOPED_TRACE(c.name);
    const MatrixXd inverse = least_norm(c.A, MatrixXd::Identity(c.A.rows(), c.A.rows()));
    const double size = c.A.norm(), cond = inverse.norm() * size;
    for (const VectorXd& b :
         {VectorXd(random_matrix(c.A.rows(), 1, rng)), VectorXd(c.A * random_matrix(c.A.cols(), 1, rng)),
          VectorXd(VectorXd::Zero(c.A.rows()))}) {
      const VectorXd x = rank::least_norm_solution(c.A.rows(), c.A.cols(), entries_of(c.A), b);
      ASSERT_EQ(x.size(), c.A.cols());
      const VectorXd expected = least_norm(c.A, b);
      // a residual is multiplied by the square of the condition (Bjorck 1996, theorem 1.4.6)
      const double left = size > 0 ? (c.A * expected - b).norm() / size : 0;
      EXPECT_LE((x - expected).norm(), 20 * kEps * cond * (expected.norm() + cond * left));
    }
  }
}

TEST(LeastNorm, NotANumberStaysVisible) {
  const MatrixXd A = MatrixXd::Identity(3, 3);
  const VectorXd x = rank::least_norm_solution(3, 3, entries_of(A), VectorXd(Eigen::Vector3d(1, NAN, 2)));
  EXPECT_EQ(x[0], 1);
  EXPECT_TRUE(std::isnan(x[1]));
  EXPECT_EQ(x[2], 2);
}

}  // namespace
}  // namespace manycontact::test
