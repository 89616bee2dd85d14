// SolverBoxDDP and SolverBoxFDDP report convergence at optima alone, and have Crocoddyl's iterates until then.

#include <gtest/gtest.h>

#include "manycontact/control/box_solvers.hpp"
#include "manycontact/control/lqr.hpp"
#include "support/random.hpp"

namespace manycontact::test {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Vectors = std::vector<VectorXd>;

struct Boxed {
  std::shared_ptr<ShootingProblem> problem;
  VectorXd bound;  // |u| <= bound
  std::size_t T = 0;
};

MatrixXd random_matrix(Index rows, Index cols, std::mt19937& rng) {
  return random_vector(static_cast<int>(rows * cols), rng, 1).reshaped(rows, cols);
}

// Weights are from 1e-2 to 1e2, controls cost nearly nothing in a third, and limits are tight or wide.
Boxed random_boxed(unsigned seed) {
  std::mt19937 rng(seed);
  const Index nx = 1 + rng() % 5, nu = 1 + rng() % 3;
  Boxed out;
  out.T = 1 + rng() % 12;
  out.bound = VectorXd::Constant(nu, 0.05 + 2 * std::abs(random_vector(1, rng, 1)[0]));
  const MatrixXd A = random_matrix(nx, nx, rng), B = random_matrix(nx, nu, rng), q = random_matrix(nx, nx, rng),
                 r = random_matrix(nu, nu, rng), none = MatrixXd::Zero(nx, nu);
  const double weight = std::pow(10, static_cast<int>(rng() % 5) - 2);
  const MatrixXd Q = weight * q * q.transpose(),
                 R = weight * (r * r.transpose() + (rng() % 3 == 0 ? 1e-3 : 1) * MatrixXd::Identity(nu, nu));
  const auto node = std::make_shared<ActionModelLQR>(A, B, Q, R, none);
  node->set_u_lb(-out.bound);
  node->set_u_ub(out.bound);
  out.problem = std::make_shared<ShootingProblem>(random_vector(static_cast<int>(nx), rng, 3),
                                                  ShootingProblem::Models(out.T, node),
                                                  std::make_shared<ActionModelLQR>(A, B, MatrixXd(10 * Q), R, none));
  return out;
}

// Returns the least cost: coordinate descent on the condensed quadratic program ends at the optimum of a convex one.
double least_cost(const Boxed& p) {
  const Index nu = p.bound.size(), n = static_cast<Index>(p.T) * nu;
  Vectors us(p.T);
  const auto cost = [&](const VectorXd& z) {
    for (std::size_t t = 0; t < p.T; ++t) us[t] = z.segment(static_cast<Index>(t) * nu, nu);
    return p.problem->calc(p.problem->rollout_us(us), us);
  };
  const double none = cost(VectorXd::Zero(n));
  MatrixXd H(n, n);
  VectorXd g(n), one(n), z = VectorXd::Zero(n);
  for (Index i = 0; i < n; ++i) {
    one[i] = cost(VectorXd::Unit(n, i));
    const double other = cost(-VectorXd::Unit(n, i));
    g[i] = (one[i] - other) / 2;
    H(i, i) = one[i] + other - 2 * none;
    for (Index j = 0; j < i; ++j)
      H(i, j) = H(j, i) = cost(VectorXd::Unit(n, i) + VectorXd::Unit(n, j)) - one[i] - one[j] + none;
  }
  double moved = 1;
  for (int round = 0; round < 100000 && moved > 1e-13; ++round) {
    moved = 0;
    for (Index i = 0; i < n; ++i) {
      const double bound = p.bound[i % nu], next = std::clamp(z[i] - (g[i] + H.row(i).dot(z)) / H(i, i), -bound, bound);
      moved = std::max(moved, std::abs(next - z[i]));
      z[i] = next;
    }
  }
  return cost(z);
}

template <class Solver>
void expect_optima(bool from_rollout) {
  int converged = 0;
  constexpr int kProblems = 60;
  for (unsigned seed = 1; seed <= kProblems; ++seed) {
    const Boxed p = random_boxed(seed);
    const double least = least_cost(p);
    const Vectors us(p.T, VectorXd::Zero(p.bound.size()));
    Solver solver(p.problem);
    if (!(from_rollout ? solver.solve(p.problem->rollout_us(us), us, 300, true) : solver.solve({}, {}, 300))) continue;
    ++converged;
    EXPECT_LE(solver.get_cost() - least, 1e-6 * std::max(1.0, least)) << seed;
  }
  EXPECT_GE(converged, kProblems - 2);
}

TEST(BoxVerdict, OfBoxDDP) { expect_optima<SolverBoxDDP>(false); }
TEST(BoxVerdict, OfBoxDDPFromARollout) { expect_optima<SolverBoxDDP>(true); }
TEST(BoxVerdict, OfBoxFDDP) { expect_optima<SolverBoxFDDP>(false); }
TEST(BoxVerdict, OfBoxFDDPFromARollout) { expect_optima<SolverBoxFDDP>(true); }

// x' = 2 x - 2 u, |u| <= 2, x0 = 3: the least cost is 24, at u = 2, while Crocoddyl's rule ends at 24.039.
TEST(BoxVerdict, OfAScalarProblem) {
  const MatrixXd one = MatrixXd::Identity(1, 1), none = MatrixXd::Zero(1, 1);
  const auto node =
      std::make_shared<ActionModelLQR>(MatrixXd(2 * one), MatrixXd(-2 * one), none, MatrixXd(4 * one), none);
  node->set_u_lb(VectorXd::Constant(1, -2));
  node->set_u_ub(VectorXd::Constant(1, 2));
  const auto problem =
      std::make_shared<ShootingProblem>(VectorXd::Constant(1, 3), ShootingProblem::Models{node},
                                        std::make_shared<ActionModelLQR>(one, none, MatrixXd(8 * one), one, none));
  const Vectors us(1, VectorXd::Zero(1));
  SolverBoxDDP ddp(problem);
  EXPECT_TRUE(ddp.solve(problem->rollout_us(us), us, 300, true));
  EXPECT_NEAR(ddp.get_cost(), 24, 1e-8);
  EXPECT_NEAR(ddp.get_us()[0][0], 2, 1e-8);
}

// Records the controls of each iteration.
class Keep : public CallbackAbstract {
 public:
  void operator()(SolverAbstract& solver) override { us.push_back(solver.get_us()); }
  std::vector<Vectors> us;
};

TEST(BoxVerdict, ComesAfterCrocoddylsIterates) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const Boxed p = random_boxed(seed);
    std::vector<std::vector<Vectors>> iterates;
    for (const bool judges : {false, true}) {
      SolverBoxFDDP solver(p.problem);
      solver.set_judges(judges);
      const auto keep = std::make_shared<Keep>();
      solver.setCallbacks({keep});
      (void)solver.solve({}, {}, 300);
      iterates.push_back(keep->us);
    }
    ASSERT_GE(iterates[1].size(), 1u);
    const std::size_t common = std::min(iterates[0].size(), iterates[1].size());
    for (std::size_t k = 0; k < common; ++k) EXPECT_EQ(iterates[0][k], iterates[1][k]) << seed << " " << k;
  }
}

}  // namespace
}  // namespace manycontact::test
