// Solvers report correctly on nodes without controls, tight limits, infeasibility and scale.

#include "control/nodes.hpp"
#include "support/dense.hpp"

namespace manycontact::test {
namespace {

using Vectors = std::vector<Eigen::VectorXd>;

// x' = 2 x, no controls.
TEST(NodesWithoutControls, MoveInRolloutsAndInEverySolver) {
  const Eigen::MatrixXd A = 2 * Eigen::MatrixXd::Identity(2, 2), B(2, 0), Q = Eigen::MatrixXd::Identity(2, 2), R(0, 0),
                        N(2, 0);
  const NodePtr node = std::make_shared<ActionModelLQR>(A, B, Q, R, N);
  const Eigen::Vector2d x0(1, -3);
  const auto problem = std::make_shared<ShootingProblem>(x0, std::vector<NodePtr>(3, node), node);
  const Vectors us(3, Eigen::VectorXd(0)), xs(4, Eigen::VectorXd::Zero(2));
  EXPECT_EQ(problem->rollout_us(us)[3], 8 * x0);
  SolverDDP ddp(problem);
  SolverFDDP fddp(problem);
  SolverBoxDDP box_ddp(problem);
  SolverBoxFDDP box_fddp(problem);
  SolverSparse sparse(problem);
  SolverAugmentedLagrangian constrained(problem);
  for (SolverAbstract* solver : std::vector<SolverAbstract*>{&ddp, &fddp, &box_ddp, &box_fddp, &sparse, &constrained}) {
    EXPECT_TRUE(solver->solve(xs, us, 20)) << to_string(solver->reason());
    EXPECT_LT((solver->get_xs()[3] - 8 * x0).norm(), 1e-12);
    EXPECT_NEAR(solver->get_cost(), 0.5 * 10 * (1 + 4 + 16 + 64), 1e-9);
  }
}

// Returns a cart pushed by u, x = (p, v), with the goal p = 1 at rest after T steps, |u| <= limit.
NodePtr cart(double limit, double of_u, double of_x, double h = 0.05) {
  Eigen::MatrixXd A(2, 2), B(2, 1);
  A << 1, h, 0, 1;
  B << h * h, h;
  const auto out = std::make_shared<ActionModelLQR>(
      A, B, of_x * Eigen::MatrixXd::Identity(2, 2), Eigen::MatrixXd::Constant(1, 1, of_u), Eigen::MatrixXd::Zero(2, 1),
      Eigen::VectorXd::Zero(2), -of_x * Eigen::Vector2d(1, 0), Eigen::VectorXd::Zero(1));
  out->set_u_lb(Eigen::VectorXd::Constant(1, -limit));
  out->set_u_ub(Eigen::VectorXd::Constant(1, limit));
  return out;
}

// Returns the controls of least cost within the limits, from projected gradients on the controls alone.
Eigen::VectorXd best_controls(int T, double limit, double of_u, double of_x, double h = 0.05) {
  Eigen::MatrixXd S(2, T);
  for (int t = 0; t < T; ++t) S.col(t) << h * h * (T - t), h;
  const Eigen::MatrixXd H = of_u * Eigen::MatrixXd::Identity(T, T) + of_x * S.transpose() * S;
  const Eigen::VectorXd g = of_x * S.transpose() * Eigen::Vector2d(1, 0);
  if (!std::isfinite(limit)) return solved(H, g);
  const double step = 1 / H.norm();
  Eigen::VectorXd u = Eigen::VectorXd::Zero(T), y = u;
  double momentum = 1;
  for (int k = 0; k < 200000; ++k) {
    const Eigen::VectorXd next = (y - step * (H * y - g)).cwiseMax(-limit).cwiseMin(limit);
    const double m = (1 + std::sqrt(1 + 4 * momentum * momentum)) / 2;
    y = next + (momentum - 1) / m * (next - u);
    const Eigen::VectorXd slope = next - (next - (H * next - g)).cwiseMax(-limit).cwiseMin(limit);
    if (slope.norm() < 1e-13) return next;
    u = next;
    momentum = m;
  }
  return u;
}

// A solution reported as converged is the optimum, with a KKT residual of 1e-9; torques never exceed their limits.
TEST(TightLimits, GuessesBeyondThemAreClampedAndOnlyTheOptimumIsCalledConverged) {
  constexpr int T = 20;
  for (const double limit : {0.5, 2.0, 8.0, 100.0}) {
    const NodePtr running = cart(limit, 1e-2, 0), last = cart(limit, 1, 100);
    const Eigen::Vector2d x0 = Eigen::Vector2d::Zero();
    const auto problem = std::make_shared<ShootingProblem>(x0, std::vector<NodePtr>(T, running), last);
    const Eigen::VectorXd best = best_controls(T, limit, 1e-2, 100);
    for (const double guess : {0.0, 50.0}) {
      SolverBoxFDDP solver(problem);
      solver.set_th_stop(1e-12);
      solver.set_th_kkt(1e-9);
      const bool converged = solver.solve(Vectors(T + 1, x0), Vectors(T, Eigen::VectorXd::Constant(1, guess)), 300);
      if (limit > 50) {
        EXPECT_TRUE(converged) << guess << " " << to_string(solver.reason());
      }
      for (int t = 0; t < T; ++t) {
        const double u = solver.get_us()[static_cast<std::size_t>(t)][0];
        EXPECT_LE(std::abs(u), limit);
        if (converged) {
          EXPECT_NEAR(u, best[t], 1e-5 * std::max(1.0, limit)) << limit << " " << guess << " " << t;
        }
      }
    }
  }
}

TEST(TightLimits, OfNoControlAtAllLeaveTheMotionThatIsLeft) {
  const NodePtr node = cart(0, 1e-2, 1);
  const Eigen::Vector2d x0(0, 1);
  const auto problem = std::make_shared<ShootingProblem>(x0, std::vector<NodePtr>(10, node), node);
  SolverBoxFDDP solver(problem);
  EXPECT_TRUE(solver.solve(Vectors(11, x0), Vectors(10, Eigen::VectorXd::Constant(1, 3)), 50))
      << to_string(solver.reason());
  EXPECT_NEAR(solver.get_xs().back()[0], 0.5, 1e-12);
}

// The cart has constraints at its end, p = goal and v = 0, and limits as constraints on u.
class Bounded : public ActionModelAbstract {
 public:
  Bounded(NodePtr cart, double goal, double limit)
      : ActionModelAbstract(cart->get_state(), 1, 0, std::isfinite(limit) ? 1 : 0, 0, 0, 2), cart_(cart), goal_(goal) {
    g_lb_ = Eigen::VectorXd::Constant(static_cast<Eigen::Index>(ng_), -limit);
    g_ub_ = -g_lb_;
  }
  const Eigen::VectorXd& get_g_lb_T() const override { return none_; }
  const Eigen::VectorXd& get_g_ub_T() const override { return none_; }
  void calc(const NodeDataPtr& d, const ConstVectorRef& x, const ConstVectorRef& u) override {
    cart_->calc(d, x, u);
    d->g = u.head(static_cast<Eigen::Index>(ng_));
    d->h.resize(0);
  }
  void calc(const NodeDataPtr& d, const ConstVectorRef& x) override {
    cart_->calc(d, x);
    d->g.resize(0);
    d->h = x - Eigen::Vector2d(goal_, 0);
  }
  void calcDiff(const NodeDataPtr& d, const ConstVectorRef& x, const ConstVectorRef& u) override {
    cart_->calcDiff(d, x, u);
    d->Gx.setZero(static_cast<Eigen::Index>(ng_), 2);
    d->Gu.setIdentity(static_cast<Eigen::Index>(ng_), 1);
    d->Hx.resize(0, 2);
    d->Hu.resize(0, 1);
  }
  void calcDiff(const NodeDataPtr& d, const ConstVectorRef& x) override {
    cart_->calcDiff(d, x);
    d->Gx.resize(0, 2);
    d->Hx.setIdentity(2, 2);
  }

 private:
  NodePtr cart_;
  double goal_;
  Eigen::VectorXd none_;
};

class Count : public CallbackAbstract {
 public:
  void operator()(SolverAbstract&) override { ++iterations; }
  std::size_t iterations = 0;
};

struct Reached {
  bool converged = false;
  StopReason reason = StopReason::kNone;
  double cost = 0, violation = 0;
  std::size_t iterations = 0;
};
Reached reach(int T, double h, double weight, double limit, double goal = 0.5, std::size_t most = 500) {
  const NodePtr node = std::make_shared<Bounded>(cart(INFINITY, h * weight, 0, h), goal, limit);
  const Eigen::Vector2d x0 = Eigen::Vector2d::Zero();
  const auto problem =
      std::make_shared<ShootingProblem>(x0, std::vector<NodePtr>(static_cast<std::size_t>(T), node), node);
  SolverAugmentedLagrangian solver(problem);
  solver.set_penalty_init(h);
  solver.set_measures_scale(true);
  const auto count = std::make_shared<Count>();
  solver.setCallbacks({count});
  Reached out;
  out.converged = solver.solve(Vectors(static_cast<std::size_t>(T) + 1, x0),
                               Vectors(static_cast<std::size_t>(T), Eigen::VectorXd::Zero(1)), most);
  out.iterations = count->iterations;
  out.reason = solver.reason();
  out.cost = solver.get_cost();
  out.violation = solver.get_violation();
  return out;
}

// The constraints can always be met, at the cost of the least-norm controls.
TEST(Infeasible, IsNeverSaidOfWhatCanBeMet) {
  std::mt19937 rng(4);
  for (int k = 0; k < 120; ++k) {
    const int T = 2 + static_cast<int>(rng() % 60);
    const double h = std::pow(10, uniform(rng, -2, -0.7)), weight = std::pow(10, uniform(rng, -6, 4));
    Eigen::MatrixXd S(2, T);
    for (int t = 0; t < T; ++t) S.col(t) << h * h * (T - t), h;
    const Eigen::VectorXd u = S.transpose() * solved(S * S.transpose(), Eigen::Vector2d(0.5, 0));
    const double right = 0.5 * h * weight * u.squaredNorm();
    const Reached found = reach(T, h, weight, INFINITY);
    EXPECT_NE(found.reason, StopReason::kInfeasible) << T << " " << h << " " << weight;
    EXPECT_TRUE(found.converged) << T << " " << h << " " << weight << " " << to_string(found.reason);
    EXPECT_NEAR(found.cost, right, 1e-5 * right) << T << " " << h << " " << weight;
  }
}

// The cart cannot be that far in that time: with all its force one way and then the other it reaches `most`.
TEST(Infeasible, IsSaidOfWhatCannotAndOfNothingElse) {
  constexpr int T = 20;
  constexpr double h = 0.05, limit = 2;
  double most = 0;
  for (int t = 0; t < T; ++t) most += h * h * (T - t) * (t < T / 2 ? limit : -limit);
  for (const double share : {0.2, 0.9, 0.99, 1.01, 1.2, 3.0}) {
    const Reached found = reach(T, h, 1e-3, limit, share * most);
    if (share < 0.95) {
      EXPECT_TRUE(found.converged) << share << " " << to_string(found.reason);
    }
    EXPECT_EQ(found.reason == StopReason::kInfeasible, share > 1) << share << " " << to_string(found.reason);
    if (share > 1) {
      EXPECT_GT(found.violation, 0.1 * (share - 1) * most) << share;
    }
  }
}

// Those of searches for the least violation, and of quasi-Newton steps within limits, count.
TEST(Iterations, AreAtMostThoseAskedFor) {
  constexpr int T = 20;
  const Eigen::Vector2d x0 = Eigen::Vector2d::Zero();
  for (const std::size_t most : {5, 20, 40, 80}) {
    for (const double goal : {0.3, 0.6, 3.0}) EXPECT_LE(reach(T, 0.05, 1e-3, 2, goal, most).iterations, most) << goal;
    const NodePtr running = cart(0.5, 1e-2, 0), last = cart(0.5, 1, 100);
    SolverBoxFDDP solver(std::make_shared<ShootingProblem>(x0, std::vector<NodePtr>(T, running), last));
    const auto count = std::make_shared<Count>();
    solver.setCallbacks({count});
    solver.set_th_kkt(1e-15);
    (void)solver.solve(Vectors(T + 1, x0), Vectors(T, Eigen::VectorXd::Constant(1, 0.2)), most);
    EXPECT_LE(count->iterations, most);
  }
}

TEST(Scale, TheSameProblemTimesAPowerOfTwoGivesTheSameBits) {
  constexpr int T = 20;
  Vectors first;
  std::size_t iterations = 0;
  for (const int power : {-40, -30, 30, 40}) {
    const double s = std::ldexp(1, power);
    const NodePtr running = cart(INFINITY, 5e-5 * s, 0), last = cart(INFINITY, s, s);
    const Eigen::Vector2d x0 = Eigen::Vector2d::Zero();
    SolverFDDP solver(std::make_shared<ShootingProblem>(x0, std::vector<NodePtr>(T, running), last));
    solver.set_measures_scale(true);
    solver.set_th_kkt(1e-6);
    EXPECT_TRUE(solver.solve(Vectors(T + 1, x0), Vectors(T, Eigen::VectorXd::Zero(1)), 100))
        << power << " " << to_string(solver.reason());
    const Eigen::VectorXd best = best_controls(T, INFINITY, 5e-5, 1);
    for (int t = 0; t < T; ++t)
      EXPECT_NEAR(solver.get_us()[static_cast<std::size_t>(t)][0], best[t], 1e-6 * best.norm()) << power;
    if (power == -40 || power == 30) {
      first = solver.get_us();
      iterations = solver.get_iter();
      continue;
    }
    EXPECT_EQ(solver.get_iter(), iterations);
    for (int t = 0; t < T; ++t)
      EXPECT_EQ(solver.get_us()[static_cast<std::size_t>(t)], first[static_cast<std::size_t>(t)]);
  }
}

TEST(Scale, OfOrdinaryProblemsIsOne) {
  const auto problem = reaching_humanoid(5);
  SolverFDDP solver(problem);
  solver.set_measures_scale(true);
  const Guess guess = standing(*problem);
  solver.solve(guess.xs, guess.us, 3);
  EXPECT_EQ(solver.get_scale(), 1);
  EXPECT_THROW(solver.set_scale(0), std::invalid_argument);
}

// The slopes of its costs are twice too large, so that directions end where the cost still falls.
class SteepUnicycle : public ActionModelUnicycle {
 public:
  void calcDiff(const NodeDataPtr& data, const ConstVectorRef& x, const ConstVectorRef& u) override {
    ActionModelUnicycle::calcDiff(data, x, u);
    data->Lx *= 2;
  }
  void calcDiff(const NodeDataPtr& data, const ConstVectorRef& x) override {
    ActionModelUnicycle::calcDiff(data, x);
    data->Lx *= 2;
  }
};

// No step falls there, and the regularisation grows until every direction is short.
TEST(Regularisation, AloneIsNoConvergence) {
  const NodePtr node = std::make_shared<SteepUnicycle>();
  const auto problem =
      std::make_shared<ShootingProblem>(Eigen::Vector3d(-1, -1, 1), std::vector<NodePtr>(20, node), node);
  SolverDDP ddp(problem);
  SolverFDDP fddp(problem);
  SolverSparse sparse(problem);
  SolverBoxDDP box_ddp(problem);
  SolverBoxFDDP box_fddp(problem);
  SolverAugmentedLagrangian constrained(problem);
  for (SolverAbstract* solver : std::vector<SolverAbstract*>{&ddp, &fddp, &sparse, &box_ddp, &box_fddp, &constrained}) {
    solver->set_th_stop(1e-4);  // met by the largest regularisations
    EXPECT_FALSE(solver->solve({}, {}, 300));
  }
  EXPECT_EQ(ddp.reason(), StopReason::kNoStep);
  ddp.set_judges(false);  // leaves the rule of Crocoddyl
  EXPECT_TRUE(ddp.solve({}, {}, 300));
  EXPECT_GT(ddp.get_preg(), 1);
  const auto right = std::make_shared<ShootingProblem>(
      Eigen::Vector3d(-1, -1, 1), std::vector<NodePtr>(20, std::make_shared<ActionModelUnicycle>()),
      std::make_shared<ActionModelUnicycle>());
  SolverDDP descent(right);
  const Vectors us(20, Eigen::VectorXd::Zero(2));
  descent.setCandidate(right->rollout_us(us), us, true);
  descent.set_preg(1e9);
  EXPECT_EQ(descent.descend(200), StopReason::kConverged) << to_string(descent.reason());
  SolverDDP best(right);
  EXPECT_TRUE(best.solve({}, {}, 100));
  EXPECT_NEAR(descent.get_cost(), best.get_cost(), 1e-7);
}

// The cost is semidefinite by construction, of any size: eigenvalues of rounding size are not concave.
TEST(Lqr, ConvexityIsJudgedRelatively) {
  std::mt19937 rng(3);
  for (int k = 0; k < 60; ++k) {
    const double size = std::pow(10, uniform(rng, -8, 8));
    const Eigen::MatrixXd g = random_vector(4, rng), Q = size * g * g.transpose();
    const Eigen::MatrixXd A = Eigen::MatrixXd::Identity(4, 4), B = Eigen::MatrixXd::Ones(4, 1),
                          N = Eigen::MatrixXd::Zero(4, 1);
    const Eigen::MatrixXd R = size * Eigen::MatrixXd::Identity(1, 1);
    EXPECT_NO_THROW(ActionModelLQR(A, B, Q, R, N)) << size;
    EXPECT_THROW(ActionModelLQR(A, B, Q - 1e-3 * size * Eigen::MatrixXd::Identity(4, 4), R, N), std::invalid_argument);
  }
}

}  // namespace
}  // namespace manycontact::test
