// BoxQP is compared with every choice of active bounds.

#include "manycontact/control/box_qp.hpp"

#include <gtest/gtest.h>

#include "spatial/compare.hpp"
#include "support/dense.hpp"
#include "support/random.hpp"

namespace manycontact::test {
namespace {

// Returns the best of the stationary points of every face of the box.
Eigen::VectorXd by_enumeration(const Eigen::MatrixXd& H, const Eigen::VectorXd& q, const Eigen::VectorXd& lb,
                               const Eigen::VectorXd& ub) {
  const int n = static_cast<int>(q.size());
  Eigen::VectorXd best;
  double least = std::numeric_limits<double>::infinity();
  for (int face = 0; face < std::pow(3, n); ++face) {
    std::vector<int> free;
    Eigen::VectorXd x(n);
    for (int i = 0, code = face; i < n; ++i, code /= 3) {
      x[i] = code % 3 == 0 ? 0 : code % 3 == 1 ? lb[i] : ub[i];
      if (code % 3 == 0) free.push_back(i);
    }
    if (!free.empty()) {
      const Eigen::VectorXd g = q + H * x;
      x(free) = -solved(H(free, free), g(free));
    }
    if ((x.array() < lb.array()).any() || (x.array() > ub.array()).any()) continue;
    const double value = 0.5 * x.dot(H * x) + q.dot(x);
    if (value < least) least = value, best = x;
  }
  return best;
}

TEST(BoxQP, IsTheBestOfAllFaces) {
  std::mt19937 rng(4);
  int clamped = 0;
  for (int k = 0; k < 100; ++k) {
    const int n = 1 + k % 5;
    Eigen::MatrixXd root(n, n);
    for (int i = 0; i < n; ++i) root.col(i) = random_vector(n, rng);
    const Eigen::MatrixXd H = root * root.transpose() + 0.1 * Eigen::MatrixXd::Identity(n, n);
    const Eigen::VectorXd q = random_vector(n, rng), lb = random_vector(n, rng) - Eigen::VectorXd::Constant(n, 0.5);
    const Eigen::VectorXd ub = lb + random_vector(n, rng).cwiseAbs();
    BoxQP qp(n, 100, 0.1, 1e-9, 0);
    const BoxQPSolution& solution = qp.solve(H, q, lb, ub, random_vector(n, rng));
    EXPECT_TRUE(qp.is_sound());
    EXPECT_LT(difference_of(solution.x, by_enumeration(H, q, lb, ub)), 1e-7);
    EXPECT_EQ(solution.free_idx.size() + solution.clamped_idx.size(), static_cast<std::size_t>(n));
    clamped += static_cast<int>(solution.clamped_idx.size());
    std::vector<int> free(solution.free_idx.begin(), solution.free_idx.end());
    if (free.empty()) continue;
    const Eigen::MatrixXd identity = solution.Hff_inv * H(free, free);
    EXPECT_LT(difference_of(identity, Eigen::MatrixXd::Identity(identity.rows(), identity.cols()).eval()), 1e-9);
  }
  EXPECT_GT(clamped, 50);
}

// At the minimum no step is accepted, and the gradient's rounding is above a tolerance of zero.
TEST(BoxQP, EndsWhereNoStepIsAccepted) {
  std::mt19937 rng(9);
  Eigen::MatrixXd root(4, 4);
  for (int i = 0; i < 4; ++i) root.col(i) = random_vector(4, rng);
  const Eigen::MatrixXd H = root * root.transpose() + 0.1 * Eigen::MatrixXd::Identity(4, 4);
  const Eigen::VectorXd q = random_vector(4, rng), far = Eigen::VectorXd::Constant(4, 1e3);
  BoxQP qp(4, 100, 0.1, 0, 0);
  qp.solve(H, q, -far, far, Eigen::VectorXd::Zero(4));
  EXPECT_LT(qp.get_iter(), 10u);
  EXPECT_LT(difference_of(qp.get_solution().x, Eigen::VectorXd(solved(H, -q))), 1e-10);
}

TEST(BoxQP, SaysWhenTheMatrixIsNotPositive) {
  BoxQP qp(2);
  const Eigen::Vector2d q(1, -1), lb(-1, -1), ub(1, 1);
  Eigen::MatrixXd H = -Eigen::MatrixXd::Identity(2, 2);
  qp.solve(H, q, lb, ub, Eigen::Vector2d::Zero());
  EXPECT_FALSE(qp.is_sound());
  EXPECT_THROW(qp.solve(H, Eigen::Vector3d::Zero(), lb, ub, q), std::invalid_argument);
  EXPECT_THROW(qp.set_th_acceptstep(0.5), std::invalid_argument);
  EXPECT_THROW(BoxQP(2, 100, 0.1, -1), std::invalid_argument);
}

}  // namespace
}  // namespace manycontact::test
