// Problems have the structure of contact dynamics: x = (q, v), M a = u + J^T w + G x, equal J a at the two ends of a
// coupling, Euler's step of 10 ms, and costs of usual weights.

#include <gtest/gtest.h>

#include "manycontact/lq/coupling_schur.hpp"
#include "manycontact/lq/kkt.hpp"
#include "random_problem.hpp"
#include "support/dense.hpp"

namespace manycontact::test {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

MatrixXd random(Eigen::Index rows, Eigen::Index cols, std::mt19937& rng) {
  std::normal_distribution<double> normal;
  return MatrixXd::NullaryExpr(rows, cols, [&] { return normal(rng); });
}

struct Sizes {
  int robots, velocities, controls, rows, horizon;
};

// Fills robot g of a knot. ends: +1 or -1 for each of its couplings.
void fill(lq::Group& g, const std::vector<int>& ends, const Sizes& n, bool terminal, std::mt19937& rng) {
  const int nv = n.velocities, m = n.rows, nw = m * static_cast<int>(ends.size());
  const double h = 0.01;
  MatrixXd M = random(nv, nv, rng);
  M = (M * M.transpose() / nv + 0.1 * MatrixXd::Identity(nv, nv)).eval();
  MatrixXd J(nw, nv);
  for (std::size_t b = 0; b < ends.size(); ++b) J.middleRows(b * m, m) = ends[b] * random(m, nv, rng);
  const double weight = terminal ? 1e3 : 10 * h;
  g.Q.diagonal() << VectorXd::Constant(nv, weight), VectorXd::Constant(nv, 0.1 * weight);
  g.q = weight * random(2 * nv, 1, rng);
  if (terminal) return;
  g.R.topLeftCorner(n.controls, n.controls).diagonal().setConstant(1e-3 * h);
  g.r.head(n.controls) = 1e-3 * random(n.controls, 1, rng);
  MatrixXd inputs = MatrixXd::Zero(nv, n.controls + nw);  // of M a
  inputs.bottomLeftCorner(n.controls, n.controls).setIdentity();
  inputs.rightCols(nw) = J.transpose();
  const MatrixXd a_v = solved(M, inputs), a_x = solved(M, random(nv, 2 * nv, rng));
  g.A.setIdentity();
  g.A.topRightCorner(nv, nv).diagonal().setConstant(h);
  g.A.bottomRows(nv) += h * a_x;
  g.B.bottomRows(nv) = h * a_v;
  g.f = 0.01 * random(2 * nv, 1, rng);
  g.C = J * a_x;
  g.D = J * a_v;
  g.d = random(nw, 1, rng);
}

lq::Problem chain(const Sizes& n, std::mt19937& rng) {
  lq::Problem problem = chain_of_robots(n.robots, n.horizon, rng, 2 * n.velocities, n.controls, n.rows);
  lq::set_zero(problem);
  for (int k = 0; k <= n.horizon; ++k)
    for (lq::Group& g : problem.knots[k].groups) {
      std::vector<int> ends;
      for (int b : g.couplings) ends.push_back(b == g.blocks[0] ? 1 : -1);
      fill(g, ends, n, k == n.horizon, rng);
    }
  problem.x0 = 0.1 * random(problem.x0.size(), 1, rng);
  return problem;
}

class LqContacts : public testing::TestWithParam<Sizes> {};

TEST_P(LqContacts, CouplingsGiveWhatTheDenseRecursionGives) {
  std::mt19937 rng(7);
  const lq::Problem problem = chain(GetParam(), rng);
  lq::Riccati dense(lq::Join::kAll);
  lq::CouplingSchur schur;
  std::vector<VectorXd> answers;
  for (lq::DirectionSolver* solver : std::initializer_list<lq::DirectionSolver*>{&dense, &schur}) {
    solver->analyse(problem);
    lq::Outcome outcome = solver->factorize(problem);
    ASSERT_EQ(outcome.status, lq::Status::kOk) << solver->name() << ", knot " << outcome.knot;
    lq::Point z;
    outcome = solver->solve(problem, z);
    EXPECT_EQ(outcome.status, lq::Status::kOk) << solver->name();
    EXPECT_LE(outcome.kkt_error, lq::kRefineAbove) << solver->name();
    RecordProperty(std::string(solver->name()) + " refinements", outcome.refinements);
    z.lambda.clear();  // other units; the multipliers follow from the rest
    z.mu.clear();
    answers.push_back(flat(z));
  }
  EXPECT_LE((answers[1] - answers[0]).cwiseAbs().maxCoeff(), 1e-9 * answers[0].cwiseAbs().maxCoeff());
}

INSTANTIATE_TEST_SUITE_P(Chains, LqContacts,
                         testing::Values(Sizes{3, 6, 6, 3, 20}, Sizes{3, 9, 3, 3, 30}, Sizes{5, 8, 5, 4, 12},
                                         Sizes{3, 38, 32, 6, 25}),
                         [](const auto& info) {
                           const Sizes& n = info.param;
                           return std::to_string(n.robots) + "RobotsOf" + std::to_string(n.velocities) +
                                  "VelocitiesFor" + std::to_string(n.horizon) + "Knots";
                         });

}  // namespace
}  // namespace manycontact::test
