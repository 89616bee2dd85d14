// SolverKKT solves linear-quadratic problems in one step, and nonlinear ones to FDDP's optimum.

#include "solver_kkt.hpp"

#include <gtest/gtest.h>

#include "manycontact/control/fddp.hpp"
#include "manycontact/control/lqr.hpp"
#include "manycontact/control/unicycle.hpp"
#include "support/random.hpp"

namespace manycontact::test {
namespace {

using Eigen::VectorXd;

TEST(SolverKKT, SolvesLinearQuadraticProblemsInOneStep) {
  std::vector<std::shared_ptr<ActionModelAbstract>> nodes;
  for (int t = 0; t < 6; ++t) nodes.push_back(std::make_shared<ActionModelLQR>(ActionModelLQR::Random(4, 2)));
  std::mt19937 rng(2);
  const auto problem = std::make_shared<ShootingProblem>(
      random_vector(4, rng), nodes, std::make_shared<ActionModelLQR>(ActionModelLQR::Random(4, 2)));
  SolverKKT kkt(problem);
  EXPECT_TRUE(kkt.solve());
  EXPECT_LE(kkt.get_iter(), 2u);
  EXPECT_EQ(kkt.get_kkt().rows(), 2 * 7 * 4 + 6 * 2);
  EXPECT_EQ(kkt.get_kkt(), kkt.get_kkt().transpose());
  SolverFDDP fddp(problem);
  EXPECT_TRUE(fddp.solve());
  for (std::size_t t = 0; t < 6; ++t) EXPECT_LE((kkt.get_us()[t] - fddp.get_us()[t]).norm(), 1e-7) << t;
}

TEST(SolverKKT, SolvesNonlinearProblems) {
  const auto node = std::make_shared<ActionModelUnicycle>();
  const auto problem =
      std::make_shared<ShootingProblem>(Eigen::Vector3d(1, 0.3, 0.1), ShootingProblem::Models(8, node), node);
  SolverKKT kkt(problem);
  EXPECT_TRUE(kkt.solve({}, {}, 200));
  EXPECT_EQ(kkt.reason(), StopReason::kConverged);
  SolverFDDP fddp(problem);
  EXPECT_TRUE(fddp.solve({}, {}, 200));
  EXPECT_NEAR(kkt.get_cost(), fddp.get_cost(), 1e-6 * fddp.get_cost());
}

}  // namespace
}  // namespace manycontact::test
