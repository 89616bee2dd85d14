// Solvers are attacked with random problems of known solutions: linear dynamics and convex costs, whose optimum solves
// one dense system in the controls. Constraints are feasible or not, and there are limits.

#include <Eigen/LU>
#include <cstdlib>

#include "control/nodes.hpp"

namespace manycontact::test {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using Vectors = std::vector<VectorXd>;

MatrixXd random_entries(int rows, int cols, std::mt19937& rng) {
  return random_vector(rows * cols, rng).reshaped(rows, cols);
}

// x_(t+1) = A x_t + B u_t + f in each node, so that the last x = S u + c in all controls u, and the cost is 1/2 u^T H u
// + g^T u plus a constant. The last node has the constraints C x = d.
struct RandomProblem {
  int T, nx, nu;
  std::shared_ptr<ShootingProblem> problem;
  MatrixXd H, S;
  VectorXd g, c;
  Vectors xs, us;  // a guess with gaps

  RandomProblem(int seed, double weight = 1, double limit = kInfinity, const MatrixXd& C = MatrixXd(),
                const VectorXd& d = VectorXd()) {
    std::mt19937 rng(seed);
    T = 2 + seed % 9;
    nx = 2 + seed % 4;
    nu = 1 + seed % 3;
    const VectorXd x0 = random_vector(nx, rng);
    H = MatrixXd::Zero(T * nu, T * nu);
    g = VectorXd::Zero(T * nu);
    S = MatrixXd::Zero(nx, T * nu);
    c = x0;
    std::vector<NodePtr> running;
    NodePtr last;
    for (int t = 0; t <= T; ++t) {
      const MatrixXd A = MatrixXd::Identity(nx, nx) + 0.3 * random_entries(nx, nx, rng),
                     B = random_entries(nx, nu, rng), G = random_entries(nx, nx, rng), P = random_entries(nu, nu, rng);
      const MatrixXd Q = weight * G.transpose() * G,
                     R = weight * (P.transpose() * P + 0.1 * MatrixXd::Identity(nu, nu));
      const VectorXd f = random_vector(nx, rng), q = weight * random_vector(nx, rng),
                     r = weight * random_vector(nu, rng);
      H += S.transpose() * Q * S;
      g += S.transpose() * (Q * c + q);
      if (t == T) {
        MatrixXd rows = MatrixXd::Zero(C.rows(), nx + nu);
        if (C.size() > 0) rows.leftCols(nx) = C;
        last = std::make_shared<ActionModelLQR>(A, B, Q, R, MatrixXd::Zero(nx, nu), MatrixXd::Zero(0, nx + nu), rows, f,
                                                q, r, VectorXd(0), -d);
        break;
      }
      H.block(t * nu, t * nu, nu, nu) += R;
      g.segment(t * nu, nu) += r;
      S = (A * S).eval();
      S.middleCols(t * nu, nu) += B;
      c = A * c + f;
      running.push_back(std::make_shared<ActionModelLQR>(A, B, Q, R, MatrixXd::Zero(nx, nu), f, q, r));
      running.back()->set_u_lb(VectorXd::Constant(nu, -limit));
      running.back()->set_u_ub(VectorXd::Constant(nu, limit));
    }
    problem = std::make_shared<ShootingProblem>(x0, running, last);
    for (int t = 0; t <= T; ++t) xs.push_back(random_vector(nx, rng));
    for (int t = 0; t < T; ++t) us.push_back(random_vector(nu, rng));
  }

  // [H M^T; M 0] [u; y] = [-g; b] has the least cost subject to M u = b.
  VectorXd best(const MatrixXd& M, const VectorXd& b) const {
    MatrixXd kkt = MatrixXd::Zero(H.rows() + M.rows(), H.rows() + M.rows());
    kkt.topLeftCorner(H.rows(), H.cols()) = H / H.norm();
    kkt.bottomLeftCorner(M.rows(), M.cols()) = M;
    kkt.topRightCorner(M.cols(), M.rows()) = M.transpose();
    VectorXd right(kkt.rows());
    right << -g / H.norm(), b;
    return kkt.partialPivLu().solve(right).head(H.rows());
  }
  VectorXd best() const { return best(MatrixXd(0, H.cols()), VectorXd(0)); }
  // Uses projected gradients with momentum within the limits, until one is close to zero.
  VectorXd best_within(double limit) const {
    const double step = 1 / H.norm();
    VectorXd u = VectorXd::Zero(g.size()), y = u;
    double momentum = 1;
    for (int k = 0; k < 200000; ++k) {
      const VectorXd next = (y - step * (H * y + g)).cwiseMax(-limit).cwiseMin(limit);
      if ((next - (next - step * (H * next + g)).cwiseMax(-limit).cwiseMin(limit)).norm() < 1e-14) return next;
      if ((y - next).dot(next - u) > 0) momentum = 1;  // it climbs
      const double m = (1 + std::sqrt(1 + 4 * momentum * momentum)) / 2;
      y = next + (momentum - 1) / m * (next - u);
      u = next;
      momentum = m;
    }
    return u;
  }
  double cost(const VectorXd& u) const { return 0.5 * u.dot(H * u) + g.dot(u); }
  static VectorXd stacked(const Vectors& us) {
    VectorXd out(static_cast<Eigen::Index>(us.size()) * us[0].size());
    for (std::size_t t = 0; t < us.size(); ++t)
      out.segment(static_cast<Eigen::Index>(t) * us[0].size(), us[0].size()) = us[t];
    return out;
  }
};

// A guess with gaps that is marked as feasible is solved as one that is not.
TEST(RandomProblems, AMarkAgainstTheGapsIsIgnored) {
  for (int seed = 0; seed < 50; ++seed) {
    SCOPED_TRACE(seed);
    std::vector<std::vector<Vectors>> results;
    for (const bool marked : {false, true}) {
      const RandomProblem p(seed, 1, seed % 2 ? kInfinity : 0.5);
      SolverDDP ddp(p.problem);
      SolverFDDP fddp(p.problem);
      SolverBoxDDP box_ddp(p.problem);
      SolverBoxFDDP box_fddp(p.problem);
      SolverSparse sparse(p.problem);
      SolverAugmentedLagrangian constrained(p.problem);
      results.emplace_back();
      for (SolverAbstract* solver :
           std::vector<SolverAbstract*>{&ddp, &fddp, &box_ddp, &box_fddp, &sparse, &constrained}) {
        (void)solver->solve(p.xs, p.us, 50, marked);
        results.back().push_back(solver->get_us());
      }
    }
    EXPECT_EQ(results[0], results[1]);
  }
}

TEST(RandomProblems, EverySolverEndsAtTheOptimum) {
  for (int seed = 0; seed < 200; ++seed) {
    SCOPED_TRACE(seed);
    const RandomProblem p(seed);
    const VectorXd best = p.best();
    SolverDDP ddp(p.problem);
    SolverFDDP fddp(p.problem);
    SolverBoxDDP box_ddp(p.problem);
    SolverBoxFDDP box_fddp(p.problem);
    SolverSparse sparse(p.problem);
    for (SolverAbstract* solver : std::vector<SolverAbstract*>{&ddp, &fddp, &box_ddp, &box_fddp, &sparse}) {
      solver->set_th_stop(1e-14);
      EXPECT_TRUE(solver->solve(p.xs, p.us, 50)) << to_string(solver->reason());
      EXPECT_LT(error_of(RandomProblem::stacked(solver->get_us()), best), 1e-6);
    }
  }
}

TEST(RandomProblems, WeightsOfAnySizeGiveTheSameMotion) {
  for (int seed = 0; seed < 40; ++seed)
    for (const double weight : {1e-12, 1e-8, 1e-4, 1.0, 1e4, 1e8, 1e12}) {
      SCOPED_TRACE(std::to_string(seed) + ", weights " + std::to_string(weight));
      const RandomProblem p(seed, weight);
      SolverFDDP solver(p.problem);
      solver.set_measures_scale(true);
      solver.set_th_kkt(1e-8);
      EXPECT_TRUE(solver.solve(p.xs, p.us, 50)) << to_string(solver.reason());
      EXPECT_LT(error_of(RandomProblem::stacked(solver.get_us()), p.best()), 1e-6);
    }
}

// Between the sizes that cost_scale brings to an ordinary one, an absolute th_kkt would accept motions beside the
// optimum for small weights.
TEST(RandomProblems, WeightsOfAnySizeGiveTheSameMotionWithinLimits) {
  for (int seed = 0; seed < 30; ++seed) {
    const double limit = 0.5 * RandomProblem(seed).best().lpNorm<Eigen::Infinity>();
    const VectorXd best = RandomProblem(seed, 1, limit).best_within(limit);
    for (int power = -8; power <= 10; ++power) {
      SCOPED_TRACE(std::to_string(seed) + ", weights times 1e" + std::to_string(power));
      const RandomProblem p(seed, std::pow(10, power), limit);
      SolverBoxDDP ddp(p.problem);
      SolverBoxFDDP fddp(p.problem);
      for (SolverDDP* solver : std::vector<SolverDDP*>{&ddp, &fddp}) {
        solver->set_measures_scale(true);
        solver->set_th_kkt(1e-7);
        EXPECT_TRUE(solver->solve(p.xs, p.us, 200)) << to_string(solver->reason());
        EXPECT_LT(error_of(RandomProblem::stacked(solver->get_us()), best), 3e-6);
      }
    }
  }
}

// The last state's goal, in some directions, is the end of a random motion.
TEST(RandomProblems, ConstraintsThatCanBeMetAreMetAtLeastCost) {
  for (int seed = 0; seed < 200; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 rng(1000 + seed);
    const RandomProblem free(seed);
    const int rows = 1 + seed % std::min(free.nx, free.T * free.nu);
    const MatrixXd C = random_entries(rows, free.nx, rng);
    const VectorXd d = C * (free.S * random_vector(free.T * free.nu, rng) + free.c);
    const RandomProblem p(seed, 1, kInfinity, C, d);
    SolverAugmentedLagrangian solver(p.problem);
    EXPECT_TRUE(solver.solve(p.xs, p.us, 500)) << to_string(solver.reason());
    EXPECT_NE(solver.reason(), StopReason::kInfeasible);
    EXPECT_LE(solver.get_violation(), 1e-8);
    const double least = p.cost(p.best(C * p.S, d - C * p.c)), found = p.cost(RandomProblem::stacked(solver.get_us()));
    EXPECT_NEAR(found, least, 1e-6 * (1 + std::abs(least)));
  }
}

// Some weights of the last three are too large for a largest penalty in absolute numbers. An absolute th_kkt accepts
// motions beside the optimum of 20, and none of 6 and 21.
TEST(RandomProblems, ConstraintsAreMetAtLeastCostWhateverTheWeights) {
  for (const int seed : {6, 20, 21, 159, 297, 399})
    for (int power = -8; power <= 10; ++power) {
      SCOPED_TRACE(std::to_string(seed) + ", weights times 1e" + std::to_string(power));
      std::mt19937 rng(1000 + seed);
      const RandomProblem free(seed);
      const int rows = 1 + seed % std::min(free.nx, free.T * free.nu);
      const MatrixXd C = random_entries(rows, free.nx, rng);
      const VectorXd d = C * (free.S * random_vector(free.T * free.nu, rng) + free.c);
      const RandomProblem p(seed, std::pow(10, power), kInfinity, C, d);
      SolverAugmentedLagrangian solver(p.problem);
      solver.set_measures_scale(true);
      solver.set_th_kkt(1e-8);
      EXPECT_TRUE(solver.solve(p.xs, p.us, 500)) << to_string(solver.reason());
      EXPECT_LE(solver.get_kkt_residual(), 1e-8);
      EXPECT_LT(error_of(RandomProblem::stacked(solver.get_us()), p.best(C * p.S, d - C * p.c)), 1e-6);
    }
}

// The same direction has two goals at once.
TEST(RandomProblems, ConstraintsThatContradictAreNeverMet) {
  for (int seed = 0; seed < 60; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 rng(2000 + seed);
    const RandomProblem free(seed);
    MatrixXd C(2, free.nx);
    C.row(0) = C.row(1) = random_vector(free.nx, rng).transpose();
    const RandomProblem p(seed, 1, kInfinity, C, Eigen::Vector2d(1, 2));
    SolverAugmentedLagrangian solver(p.problem);
    EXPECT_FALSE(solver.solve(p.xs, p.us, 500));
    EXPECT_EQ(solver.reason(), StopReason::kInfeasible) << to_string(solver.reason());
    EXPECT_NEAR(solver.get_violation(), 0.5, 0.02);
  }
}

// Here quasi-Newton steps end far from the optimum, after short steps of the box rule; from there the box rule has long
// ones.
TEST(RandomProblems, TheBoxRuleGoesOnFromWhereQuasiNewtonStepsEnd) {
  constexpr int kSeed = 230;
  const double limit = 0.5 * RandomProblem(kSeed).best().lpNorm<Eigen::Infinity>();
  const RandomProblem p(kSeed, 1, limit);
  const double best = p.cost(p.best_within(limit));
  for (const double guess : {0.0, 1.0}) {
    SCOPED_TRACE(guess);
    Vectors us = p.us;
    for (VectorXd& u : us) u *= guess;
    SolverBoxFDDP solver(p.problem);
    solver.set_th_stop(1e-12);
    solver.set_th_kkt(1e-9);
    EXPECT_TRUE(solver.solve(p.xs, us, 200)) << to_string(solver.reason());
    EXPECT_LE(solver.get_kkt_residual(), 1e-9);
    EXPECT_NEAR(p.cost(RandomProblem::stacked(solver.get_us())), best, 1e-9 * std::abs(best));
  }
}

// MANYCONTACT_CONTROL_ATTACK=1000 runs so many (tests/task/control_attack_test.cpp).
TEST(RandomProblems, LimitsAreKeptAtLeastCost) {
  const char* asked = std::getenv("MANYCONTACT_CONTROL_ATTACK");
  const int count = asked ? std::atoi(asked) : 200;
  int at_limit = 0, missed = 0;
  for (int seed = 0; seed < count; ++seed) {
    SCOPED_TRACE(seed);
    const double limit = 0.5 * RandomProblem(seed).best().lpNorm<Eigen::Infinity>();
    const RandomProblem p(seed, 1, limit);
    const VectorXd best = p.best_within(limit);
    SolverBoxFDDP solver(p.problem);
    solver.set_th_stop(1e-12);
    solver.set_th_kkt(1e-9);
    const bool converged = solver.solve(p.xs, p.us, 200);
    const VectorXd found = RandomProblem::stacked(solver.get_us());
    EXPECT_LE(found.lpNorm<Eigen::Infinity>(), limit);
    if (converged) {
      EXPECT_NEAR(p.cost(found), p.cost(best), 1e-9 * (1 + std::abs(p.cost(best))));
    } else {
      ++missed;
      std::cout << seed << ": " << to_string(solver.reason()) << ", KKT residual " << solver.get_kkt_residual()
                << ", cost off by " << p.cost(found) - p.cost(best) << " of " << p.cost(best) << "\n";
    }
    at_limit += static_cast<int>((found.array().abs() == limit).count());
  }
  EXPECT_LE(missed, count / 500);  // the solvers report them
  EXPECT_GT(at_limit, count);
}

}  // namespace
}  // namespace manycontact::test
