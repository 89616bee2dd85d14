#include "manycontact/lq/block_cholesky.hpp"

#include <gtest/gtest.h>

#include <random>

namespace manycontact::test {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// The blocks are a ring with a chord, with mixed signs; a dense matrix contains the same.
class BlockCholeskyTest : public testing::Test {
 protected:
  const std::vector<lq::BlockCholesky::Vertex> vertices = {{3, 1}, {2, -1}, {4, 1}, {0, 1}, {5, -1}, {2, 1}};
  const std::vector<std::pair<int, int>> edges = {{0, 1}, {1, 2}, {2, 4}, {4, 5}, {5, 0}, {1, 4}, {3, 0}, {2, 2}};
  lq::BlockCholesky S;
  MatrixXd dense;
  std::mt19937 rng{3};

  MatrixXd random(int rows, int cols) {
    std::normal_distribution<double> normal;
    return MatrixXd::NullaryExpr(rows, cols, [&] { return normal(rng); });
  }
  void SetUp() override {
    S.analyse(vertices, edges);
    dense = MatrixXd::Zero(S.size(), S.size());
    S.set_zero();
    for (const auto& [u, v] : edges) {
      if (u == v) continue;
      const MatrixXd M = 0.3 * random(vertices[u].size, vertices[v].size);
      S.add(u, 0, v, 0, M);
      dense.block(S.start(u), S.start(v), M.rows(), M.cols()) += M;
      dense.block(S.start(v), S.start(u), M.cols(), M.rows()) += M.transpose();
    }
    for (int v = 0; v < S.vertices(); ++v) {
      const int n = vertices[v].size;
      const MatrixXd G = random(n, n);
      const MatrixXd M = vertices[v].sign * (G * G.transpose() + 4 * MatrixXd::Identity(n, n));
      S.add(v, 0, v, 0, M);
      dense.block(S.start(v), S.start(v), n, n) += M;
    }
  }
};

TEST_F(BlockCholeskyTest, SolvesAsTheDenseMatrixDoes) {
  ASSERT_EQ(S.factorize(1e-11), -1);
  const VectorXd b = random(S.size(), 1);
  VectorXd x = b;
  S.solve(x);
  EXPECT_LE((dense * x - b).cwiseAbs().maxCoeff(), 1e-13 * (dense.cwiseAbs() * x.cwiseAbs()).maxCoeff());
}

TEST_F(BlockCholeskyTest, PartsGoToEitherTriangle) {
  const MatrixXd M = random(1, 2);
  S.add(2, 3, 2, 0, M);  // below the diagonal
  S.add(4, 0, 4, 3, M);  // above: the mirrored place
  S.add(1, 1, 4, 2, M);  // between vertices, either way
  S.add(4, 2, 1, 0, M);
  const auto put = [&](int i, int j, const MatrixXd& part) {
    dense.block(i, j, part.rows(), part.cols()) += part;
    dense.block(j, i, part.cols(), part.rows()) += part.transpose();
  };
  put(S.start(2) + 3, S.start(2), M);
  put(S.start(4), S.start(4) + 3, M);
  put(S.start(1) + 1, S.start(4) + 2, M);
  put(S.start(4) + 2, S.start(1), M);
  S.add_diagonal(0, 0.5);
  dense.diagonal().segment(S.start(0), 3).array() += 0.5;
  S.add_diagonal(2, 40);  // stays quasi-definite
  dense.diagonal().segment(S.start(2), 4).array() += 40;
  S.add_diagonal(4, -40);
  dense.diagonal().segment(S.start(4), 5).array() -= 40;
  ASSERT_EQ(S.factorize(1e-11), -1);
  const VectorXd b = random(S.size(), 1);
  VectorXd x = b;
  S.solve(x);
  EXPECT_LE((dense * x - b).cwiseAbs().maxCoeff(), 1e-13 * (dense.cwiseAbs() * x.cwiseAbs()).maxCoeff());
}

TEST_F(BlockCholeskyTest, NamesTheVertexOfAPivotOfTheWrongSign) {
  S.add_diagonal(4, 100);
  EXPECT_EQ(S.factorize(1e-11), 4);
}

TEST_F(BlockCholeskyTest, SemidefinitePartsNeedTheProximalTerm) {
  S.set_zero();
  S.add(0, 0, 1, 0, random(3, 2));
  EXPECT_EQ(S.factorize(1e-11), 0);
  S.set_zero();
  for (int v : {2, 4, 5}) S.add_diagonal(v, vertices[v].sign);
  S.add(0, 0, 1, 0, random(3, 2));
  S.add_proximal_term(1e-8);
  EXPECT_EQ(S.factorize(0), -1);
}

TEST_F(BlockCholeskyTest, BlocksOutsideThePatternAreRefused) {
  EXPECT_THROW(S.add(0, 0, 2, 0, random(3, 4)), std::logic_error);
}

}  // namespace
}  // namespace manycontact::test
