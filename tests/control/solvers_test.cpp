// DDP, FDDP and their box variants agree with the dense solution of the whole horizon, solve nonlinear problems, and
// report numerical failures.

#include <sstream>

#include "control/nodes.hpp"
#include "manycontact/control/augmented_lagrangian.hpp"
#include "support/allocations.hpp"
#include "support/dense.hpp"

namespace manycontact::test {
namespace {

using Vectors = std::vector<Eigen::VectorXd>;

std::shared_ptr<ShootingProblem> random_lqr(std::size_t T, std::size_t nx, std::size_t nu) {
  std::vector<NodePtr> nodes;
  for (std::size_t t = 0; t < T; ++t) nodes.push_back(std::make_shared<ActionModelLQR>(ActionModelLQR::Random(nx, nu)));
  std::mt19937 rng(2);
  return std::make_shared<ShootingProblem>(random_vector(static_cast<int>(nx), rng), nodes,
                                           std::make_shared<ActionModelLQR>(ActionModelLQR::Random(nx, nu)));
}

// Returns [x_0; u_0; x_1; ...] that makes the Lagrangian of a linear-quadratic problem stationary.
Eigen::VectorXd dense_solution(ShootingProblem& problem) {
  const Eigen::Index T = problem.get_T(), nx = problem.get_nx(), nu = problem.get_nu_max(), n = nx + nu;
  const Eigen::Index nz = T * n + nx, nc = (T + 1) * nx;
  Eigen::MatrixXd K = Eigen::MatrixXd::Zero(nz + nc, nz + nc);
  Eigen::VectorXd b = Eigen::VectorXd::Zero(nz + nc);
  b.segment(nz, nx) = problem.get_x0();
  K.block(nz, 0, nx, nx).setIdentity();
  for (Eigen::Index t = 0; t <= T; ++t) {
    const auto& m =
        dynamic_cast<ActionModelLQR&>(t < T ? *problem.get_runningModels()[t] : *problem.get_terminalModel());
    const Eigen::Index z = t * n, c = nz + (t + 1) * nx;
    K.block(z, z, nx, nx) = m.get_Q();
    b.segment(z, nx) = -m.get_q();
    if (t == T) break;
    K.block(z, z + nx, nx, nu) = m.get_N();
    K.block(z + nx, z, nu, nx) = m.get_N().transpose();
    K.block(z + nx, z + nx, nu, nu) = m.get_R();
    b.segment(z + nx, nu) = -m.get_r();
    K.block(c, z, nx, nx) = -m.get_A();
    K.block(c, z + nx, nx, nu) = -m.get_B();
    K.block(c, z + n, nx, nx).setIdentity();
    b.segment(c, nx) = m.get_f();
  }
  K.topRightCorner(nz, nc) = K.bottomLeftCorner(nc, nz).transpose();
  return solved(K, b).col(0).head(nz);
}

template <class Solver>
void expect_dense_solution() {
  const auto problem = random_lqr(5, 4, 2);
  const Eigen::VectorXd truth = dense_solution(*problem);
  Solver solver(problem);
  solver.set_reg_min(1e-12);
  solver.set_th_stop(1e-9);
  EXPECT_TRUE(solver.solve());
  EXPECT_EQ(solver.reason(), StopReason::kConverged);
  EXPECT_LT(error_of(stacked(solver), truth), 1e-8);
  EXPECT_TRUE(solver.get_is_feasible());
  EXPECT_LE(solver.get_iter(), 3u);
}

TEST(Solvers, DDPSolvesALinearQuadraticProblem) { expect_dense_solution<SolverDDP>(); }
TEST(Solvers, FDDPSolvesALinearQuadraticProblem) { expect_dense_solution<SolverFDDP>(); }
TEST(Solvers, BoxDDPSolvesALinearQuadraticProblem) { expect_dense_solution<SolverBoxDDP>(); }
TEST(Solvers, BoxFDDPSolvesALinearQuadraticProblem) { expect_dense_solution<SolverBoxFDDP>(); }

// The first step of a linear-quadratic problem gains as much as expected.
TEST(Solvers, ExpectedImprovementIsFoundOnALinearQuadraticProblem) {
  const auto problem = random_lqr(5, 4, 2);
  SolverFDDP solver(problem);
  solver.set_reg_min(1e-12);
  std::mt19937 rng(3);
  Vectors xs, us;
  for (int t = 0; t < 6; ++t) xs.push_back(random_vector(4, rng));
  for (int t = 0; t < 5; ++t) us.push_back(random_vector(2, rng));
  solver.solve(xs, us, 0);  // sets the candidate
  solver.set_preg(1e-12);
  solver.computeDirection(true);
  solver.updateExpectedImprovement();
  for (const double s : {1.0, 0.5, 0.125}) {
    const double dV = solver.tryStep(s);
    const Eigen::Vector2d d = solver.expectedImprovement();
    const double expected = s * (d[0] + 0.5 * s * d[1]);
    if (s == 1) {
      EXPECT_LT(std::abs(dV - expected), 1e-7 * std::abs(dV));
    }
    EXPECT_TRUE(std::isfinite(dV));
  }
  EXPECT_GT(solver.get_ffeas(), 0.1);
}

TEST(Solvers, AgreeOnTheUnicycle) {
  const auto node = std::make_shared<ActionModelUnicycle>();
  const auto problem =
      std::make_shared<ShootingProblem>(Eigen::Vector3d(-1, -1, 1), std::vector<NodePtr>(20, node), node);
  SolverDDP ddp(problem);
  SolverFDDP fddp(problem);
  EXPECT_TRUE(ddp.solve());
  EXPECT_TRUE(fddp.solve());
  EXPECT_NEAR(ddp.get_cost(), fddp.get_cost(), 1e-8 * ddp.get_cost());
  EXPECT_EQ(ddp.get_cost(), problem->calc(ddp.get_xs(), ddp.get_us()));
  // no neighbour is better
  std::mt19937 rng(1);
  for (int k = 0; k < 20; ++k) {
    Vectors us = ddp.get_us(), xs(21);
    for (Eigen::VectorXd& u : us) u += random_vector(2, rng, 1e-3);
    problem->rollout(us, xs);
    EXPECT_GT(problem->calc(xs, us), ddp.get_cost());
  }
}

TEST(Solvers, KeepControlsWithinTheirLimits) {
  for (const bool feasible : {false, true}) {
    const auto node = std::make_shared<ActionModelUnicycle>();
    node->set_u_lb(Eigen::Vector2d(-0.5, -0.4));
    node->set_u_ub(Eigen::Vector2d(0.5, 0.4));
    const auto problem =
        std::make_shared<ShootingProblem>(Eigen::Vector3d(-1, -1, 1), std::vector<NodePtr>(20, node), node);
    const auto check = [&](auto& solver) {
      Vectors us(20, Eigen::Vector2d::Zero());
      const Vectors xs = problem->rollout_us(us);
      EXPECT_TRUE(solver.solve(feasible ? xs : Vectors{}, us, 100, feasible));
      int at_limit = 0;
      for (std::size_t t = 0; t < 20; ++t) {
        const Eigen::VectorXd& u = solver.get_us()[t];
        EXPECT_TRUE((u.array() >= node->get_u_lb().array()).all() && (u.array() <= node->get_u_ub().array()).all());
        at_limit += u[0] == -0.5 || u[0] == 0.5 || u[1] == -0.4 || u[1] == 0.4;
      }
      EXPECT_GT(at_limit, 0);
      // no neighbour within the limits is better
      std::mt19937 rng(1);
      for (int k = 0; k < 20; ++k) {
        Vectors near = solver.get_us(), states(21);
        for (Eigen::VectorXd& u : near)
          u = (u + random_vector(2, rng, 1e-2)).cwiseMax(node->get_u_lb()).cwiseMin(node->get_u_ub());
        problem->rollout(near, states);
        EXPECT_GT(problem->calc(states, near), solver.get_cost());
      }
      return solver.get_cost();
    };
    SolverBoxDDP ddp(problem);
    SolverBoxFDDP fddp(problem);
    const double cost = check(ddp);
    EXPECT_NEAR(check(fddp), cost, 1e-4 * cost);
  }
}

TEST(Solvers, AHumanoidReaches) {
  const auto problem = reaching_humanoid(10);
  const Guess guess = standing(*problem);
  SolverFDDP solver(problem);
  const auto log = std::make_shared<CallbackLogger>();
  std::ostringstream text;
  solver.setCallbacks({log, std::make_shared<CallbackVerbose>(text, _3)});
  EXPECT_TRUE(solver.solve(guess.xs, guess.us, 100));
  EXPECT_EQ(log->costs.size(), solver.get_iter() + 1);
  EXPECT_EQ(log->costs.back(), solver.get_cost());
  EXPECT_EQ(log->xs, solver.get_xs());
  EXPECT_LT(solver.get_cost(), problem->calc(guess.xs, guess.us));
  EXPECT_LT(solver.get_ffeas(), 1e-10);
  EXPECT_NE(text.str().find("||ffeas||"), std::string::npos);
  EXPECT_EQ(text.str().find("dPhi"), std::string::npos);
  std::size_t lines = 0;
  for (char c : text.str()) lines += c == '\n';
  EXPECT_EQ(lines, log->costs.size() + (log->costs.size() + 9) / 10);
}

TEST(Solvers, GiveTheSameBitsForAnyNumberOfThreads) {
  std::vector<Eigen::VectorXd> answers;
  for (const int threads : {1, 2, 3}) {
    const auto problem = reaching_humanoid(7);
    problem->set_nthreads(threads);
    EXPECT_EQ(problem->get_nthreads(), static_cast<std::size_t>(threads));
    const Guess guess = standing(*problem);
    SolverFDDP solver(problem);
    solver.solve(guess.xs, guess.us, 4);
    answers.push_back(stacked(solver));
  }
  EXPECT_TRUE(answers[1] == answers[0]);
  EXPECT_TRUE(answers[2] == answers[0]);
}

TEST(Solvers, TakeNoMemoryInTheirIterations) {
  if (!MANYCONTACT_COUNTS_ALLOCATIONS) GTEST_SKIP() << "malloc cannot be counted here";
  const auto problem = reaching_humanoid(5);
  problem->set_nthreads(1);
  const Guess guess = standing(*problem);
  const auto expect_none = [&](auto&& solver) {
    solver.solve(guess.xs, guess.us, 3);
    EXPECT_EQ(allocations([&] { solver.solve(guess.xs, guess.us, 3); }), 0u);
    EXPECT_EQ(allocations([&] { solver.solve(solver.get_xs(), solver.get_us(), 3, true); }), 0u);
  };
  expect_none(SolverDDP(problem));
  expect_none(SolverFDDP(problem));
  expect_none(SolverBoxDDP(problem));
  expect_none(SolverBoxFDDP(problem));
  expect_none(SolverSparse(problem));
}

// ---- failure ------------------------------------------------------------------------------------------------------

// A unicycle that counts its calls and spoils the quantity that is requested.
class Spoiled : public ActionModelUnicycle {
 public:
  enum class What { kCost, kDerivative, kHessian, kEveryStep, kThrows };
  explicit Spoiled(What what) : what_(what) {}
  void calc(const NodeDataPtr& data, const ConstVectorRef& x, const ConstVectorRef& u) override {
    ActionModelUnicycle::calc(data, x, u);
    if (what_ == What::kCost) data->cost = NAN;
    if (what_ == What::kEveryStep && !u.isZero(0)) data->xnext[0] = INFINITY;
    if (what_ == What::kThrows) throw std::logic_error("by design");
  }
  void calcDiff(const NodeDataPtr& data, const ConstVectorRef& x, const ConstVectorRef& u) override {
    ActionModelUnicycle::calcDiff(data, x, u);
    if (what_ == What::kDerivative) data->Fx(0, 0) = NAN;
    if (what_ == What::kHessian) data->Luu(0, 0) = -1e12;
  }
  using ActionModelUnicycle::calc;
  using ActionModelUnicycle::calcDiff;

 private:
  What what_;
};

// The stopping value is an energy: where it is small enough, gradients may be large. With th_kkt solves continue from
// there, with the same iterates until there.
TEST(Solvers, GoOnUntilTheKktResidualIsSmall) {
  const auto problem = reaching_humanoid(12);
  const Guess guess = standing(*problem);
  for (const bool box : {false, true}) {
    const std::unique_ptr<SolverFDDP> solver =
        box ? std::make_unique<SolverBoxFDDP>(problem) : std::make_unique<SolverFDDP>(problem);
    const auto residual = [&] {
      const Vectors xs = solver->get_xs(), us = solver->get_us();
      return kkt_residual(*problem, xs, us, least_squares_multipliers(*problem, xs, us, box), box);
    };
    const auto log = std::make_shared<CallbackLogger>();
    solver->setCallbacks({log});
    solver->set_th_stop(1e-2);
    EXPECT_TRUE(solver->solve(guess.xs, guess.us));
    EXPECT_TRUE(std::isnan(solver->get_kkt_residual()));
    EXPECT_GT(residual(), 1e-7);
    const std::vector<double> costs = log->costs;
    log->costs.clear();
    solver->set_th_kkt(1e-7);
    EXPECT_TRUE(solver->solve(guess.xs, guess.us));
    ASSERT_LE(log->costs.size(), costs.size());  // within limits the first solve continues to the optimum itself
    EXPECT_TRUE(std::equal(log->costs.begin(), log->costs.end(), costs.begin()));
    if (!box) EXPECT_EQ(log->costs.size(), costs.size());
    EXPECT_GT(solver->get_polishing_iter(), 0u);
    EXPECT_LE(solver->get_kkt_residual(), 1e-7);
    EXPECT_EQ(residual(), solver->get_kkt_residual());
    solver->set_th_kkt(1e-300);
    EXPECT_FALSE(solver->solve(guess.xs, guess.us, 30));
    EXPECT_NE(solver->reason(), StopReason::kConverged);
  }
  EXPECT_THROW(SolverFDDP(problem).set_th_kkt(0), std::invalid_argument);
}

// Returns the multipliers of the whole horizon: l minimises |g + C^T l|, C the derivatives of the dynamics.
TEST(Solvers, MultipliersAreTheLeastSquaresOnes) {
  const std::size_t T = 5, nx = 4, nu = 2, n = nx + nu;
  const auto problem = random_lqr(T, nx, nu);
  std::mt19937 rng(3);
  Vectors xs, us;
  for (std::size_t t = 0; t <= T; ++t) {
    xs.push_back(random_vector(nx, rng));
    if (t < T) us.push_back(random_vector(nu, rng));
  }
  const Vectors l = least_squares_multipliers(*problem, xs, us, false);
  Eigen::MatrixXd C = Eigen::MatrixXd::Zero((T + 1) * nx, T * n + nx);
  Eigen::VectorXd g(T * n + nx), own((T + 1) * nx);
  for (std::size_t t = 0; t <= T; ++t) {
    const ActionDataAbstract& d = *problem->data(t);
    own.segment(t * nx, nx) = l[t];
    C.block(t * nx, t * n, nx, nx) = -Eigen::MatrixXd::Identity(nx, nx);
    g.segment(t * n, nx) = d.Lx;
    if (t == T) break;
    C.block((t + 1) * nx, t * n, nx, nx) = d.Fx;
    C.block((t + 1) * nx, t * n + nx, nx, nu) = d.Fu;
    g.segment(t * n + nx, nu) = d.Lu;
  }
  const Eigen::VectorXd truth = solved(C * C.transpose(), -C * g);
  EXPECT_LT(error_of(own, truth), 1e-9);
}

TEST(Solvers, SayWhyTheyStopped) {
  using What = Spoiled::What;
  const std::pair<What, StopReason> cases[] = {{What::kCost, StopReason::kNoStep},
                                               {What::kDerivative, StopReason::kNoDirection},
                                               {What::kHessian, StopReason::kNoDirection},
                                               {What::kEveryStep, StopReason::kNoStep}};
  for (const auto& [what, reason] : cases) {
    const auto node = std::make_shared<ActionModelUnicycle>();
    std::vector<NodePtr> nodes(10, node);
    nodes[4] = std::make_shared<Spoiled>(what);
    const auto problem = std::make_shared<ShootingProblem>(Eigen::Vector3d(-1, -1, 1), nodes, node);
    SolverDDP ddp(problem);
    SolverFDDP fddp(problem);
    SolverBoxFDDP box(problem);
    for (SolverAbstract* solver : std::initializer_list<SolverAbstract*>{&ddp, &fddp, &box}) {
      EXPECT_EQ(solver->reason(), StopReason::kNone);
      EXPECT_FALSE(solver->solve());
      EXPECT_EQ(solver->reason(), reason) << static_cast<int>(what);
    }
  }
  const auto problem = random_lqr(5, 4, 2);
  SolverFDDP solver(problem);
  EXPECT_FALSE(solver.solve({}, {}, 1));
  EXPECT_EQ(solver.reason(), StopReason::kIterations);
  struct Interrupts : CallbackAbstract {
    void operator()(SolverAbstract& solver) override { solver.interrupt(); }
  };
  solver.setCallbacks({std::make_shared<Interrupts>()});
  EXPECT_FALSE(solver.solve());
  EXPECT_EQ(solver.reason(), StopReason::kInterrupted);
  EXPECT_EQ(to_string(solver.reason()), std::string("interrupted"));
}

// Callbacks that a callback sets are called from the next iteration on; the current list stays as it is. (The address
// sanitizer checks a callback that frees itself.)
TEST(Solvers, CallbacksThatSetCallbacks) {
  struct Sets : CallbackAbstract {
    void operator()(SolverAbstract& solver) override {
      solver.setCallbacks({later, later});
      ++calls;
    }
    std::shared_ptr<CallbackLogger> later = std::make_shared<CallbackLogger>();
    int calls = 0;
  };
  const auto node = std::make_shared<ActionModelUnicycle>();
  const auto problem =
      std::make_shared<ShootingProblem>(Eigen::Vector3d(-1, -1, 1), std::vector<NodePtr>(20, node), node);
  SolverDDP ddp(problem);
  SolverFDDP fddp(problem);
  SolverBoxFDDP box(problem);
  SolverAugmentedLagrangian augmented(problem);
  for (SolverAbstract* solver : std::initializer_list<SolverAbstract*>{&ddp, &fddp, &box, &augmented}) {
    const auto sets = std::make_shared<Sets>();
    const auto later = sets->later;
    solver->setCallbacks({sets, sets, sets});
    (void)solver->solve();
    EXPECT_EQ(sets->calls, 3);
    EXPECT_GT(later->costs.size(), 1u);
    EXPECT_EQ(solver->getCallbacks().size(), 2u);
    solver->setCallbacks({std::make_shared<Sets>()});  // nothing else owns it
    (void)solver->solve({}, {}, 3);
  }
}

TEST(Solvers, PassOnWhatAModelThrows) {
  const auto node = std::make_shared<Spoiled>(Spoiled::What::kThrows);
  const auto problem =
      std::make_shared<ShootingProblem>(Eigen::Vector3d(-1, -1, 1), std::vector<NodePtr>(4, node), node);
  for (const int threads : {1, 2}) {
    problem->set_nthreads(threads);
    SolverFDDP solver(problem);
    EXPECT_THROW(solver.solve(), std::logic_error);
  }
}

TEST(Solvers, RefuseMisuse) {
  EXPECT_THROW(SolverDDP(nullptr), std::invalid_argument);
  SolverFDDP solver(random_lqr(5, 4, 2));
  EXPECT_THROW(solver.solve(Vectors(3, Eigen::VectorXd::Zero(4))), std::invalid_argument);
  EXPECT_THROW(solver.solve(Vectors(6, Eigen::VectorXd::Zero(3))), std::invalid_argument);
  EXPECT_THROW(solver.solve({}, Vectors(5, Eigen::VectorXd::Zero(3))), std::invalid_argument);
  EXPECT_THROW(solver.forwardPass(1.5), std::invalid_argument);
  EXPECT_THROW(solver.set_alphas({}), std::invalid_argument);
  EXPECT_THROW(solver.set_alphas({1, 2}), std::invalid_argument);
  EXPECT_THROW(solver.set_reg_incfactor(1), std::invalid_argument);
  EXPECT_THROW(solver.set_th_stop(0), std::invalid_argument);
  EXPECT_THROW(solver.set_preg(-1), std::invalid_argument);
  EXPECT_THROW(solver.setCallbacks({nullptr}), std::invalid_argument);
}

TEST(Solvers, HaveCrocoddylsDefaults) {
  const auto problem = random_lqr(5, 4, 2);
  SolverFDDP solver(problem);
  EXPECT_EQ(solver.get_reg_incfactor(), 10);
  EXPECT_EQ(solver.get_reg_decfactor(), 10);
  EXPECT_EQ(solver.get_reg_min(), 1e-9);
  EXPECT_EQ(solver.get_reg_max(), 1e9);
  EXPECT_EQ(solver.get_th_grad(), 1e-12);
  EXPECT_EQ(solver.get_th_stepdec(), 0.5);
  EXPECT_EQ(solver.get_th_stepinc(), 0.01);
  EXPECT_EQ(solver.get_th_acceptstep(), 0.1);
  EXPECT_EQ(solver.get_th_acceptnegstep(), 2);
  EXPECT_EQ(solver.get_th_stop(), 1e-9);
  EXPECT_EQ(solver.get_th_gaptol(), 1e-16);
  EXPECT_EQ(solver.get_alphas().size(), 10u);
  EXPECT_EQ(solver.get_alphas()[9], std::ldexp(1, -9));
  EXPECT_EQ(SolverBoxFDDP(problem).get_th_stop(), 5e-5);
  EXPECT_EQ(SolverBoxDDP(problem).get_th_stop(), 5e-5);
}

}  // namespace
}  // namespace manycontact::test
