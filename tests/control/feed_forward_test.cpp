// Quasi-Newton steps on feed-forward terms: L-BFGS, the gradient against differences of the cost, its scaling against
// the backward pass, and minima where Gauss-Newton's steps do not contract, are tested.

#include "control/nodes.hpp"

namespace manycontact::test {
namespace {

using Vectors = std::vector<Eigen::VectorXd>;

Vectors random_vectors_of(const std::vector<int>& sizes, std::mt19937& rng) {
  Vectors out;
  for (const int size : sizes) out.push_back(random_vector(size, rng));
  return out;
}

// ---- L-BFGS -------------------------------------------------------------------------------------------------------

// For a quadratic with Hessian A, H y = s is satisfied for the newest pair, and H stays symmetric and positive.
TEST(LimitedBfgs, MeetsTheSecantEquation) {
  std::mt19937 rng(1);
  const std::vector<int> sizes{3, 0, 2};
  const Eigen::MatrixXd R = random_vector(25, rng).reshaped(5, 5),
                        A = R * R.transpose() + Eigen::MatrixXd::Identity(5, 5);
  const auto times_A = [&](const Vectors& x) {
    Eigen::VectorXd all(5);
    all << x[0], x[2];
    all = A * all;
    return Vectors{all.head(3), Eigen::VectorXd(0), all.tail(2)};
  };
  LimitedBfgs bfgs(3);
  const auto times_H = [&](Vectors x) {
    bfgs.begin(x);
    for (Eigen::VectorXd& part : x) part *= 0.1;  // H0
    bfgs.finish(x);
    return x;
  };
  Vectors s, y;
  for (int k = 0; k < 5; ++k) {
    const Vectors g = random_vectors_of(sizes, rng);
    s = random_vectors_of(sizes, rng);
    y = times_A(s);
    Vectors next = g;
    for (std::size_t t = 0; t < g.size(); ++t) next[t] += y[t];
    Vectors direction = s;
    for (Eigen::VectorXd& part : direction) part *= 2;
    bfgs.add(0.5, direction, g, next);
  }
  EXPECT_EQ(bfgs.pairs(), 3u);
  const Vectors Hy = times_H(y);
  for (std::size_t t = 0; t < s.size(); ++t) EXPECT_LT((Hy[t] - s[t]).norm(), 1e-12) << t;
  const Vectors a = random_vectors_of(sizes, rng), b = random_vectors_of(sizes, rng);
  EXPECT_NEAR(dot(a, times_H(b)), dot(b, times_H(a)), 1e-12);
  EXPECT_GT(dot(a, times_H(a)), 0);
  Vectors less = y;  // negative curvature is left out
  for (std::size_t t = 0; t < s.size(); ++t) less[t] -= s[t];
  bfgs.add(1, s, y, less);
  EXPECT_LT((times_H(y)[0] - s[0]).norm(), 1e-12);
  bfgs.forget();
  EXPECT_LT((times_H(a)[0] - 0.1 * a[0]).norm(), 1e-15);
}

// ---- the gradient ---------------------------------------------------------------------------------------------------

struct Open : SolverFDDP {
  using SolverFDDP::computeFeedForwardGradient;
  using SolverFDDP::preconditionFeedForward;
  using SolverFDDP::setFeedForward;
  using SolverFDDP::SolverFDDP;
};

// Central differences with step h are accurate to h^2 and eps cost / h; the cost's third derivatives are of its size.
TEST(FeedForward, GradientIsThatOfTheRolledOutCost) {
  const auto problem = reaching_humanoid(6);
  const Guess guess = standing(*problem);
  Open solver(problem);
  solver.solve(guess.xs, guess.us, 2);
  solver.computeDirection(true);
  Vectors g;
  solver.forwardPass(0);
  problem->calcDiff(solver.get_xs(), solver.get_us());
  solver.computeFeedForwardGradient(g);
  std::mt19937 rng(4);
  constexpr double h = 1e-5;
  for (int k = 0; k < 3; ++k) {
    Vectors nu;
    for (const Eigen::VectorXd& part : g) nu.push_back(random_vector(static_cast<int>(part.size()), rng));
    const auto cost = [&](double step) {
      Vectors scaled = nu;
      for (Eigen::VectorXd& part : scaled) part *= step;
      solver.setFeedForward(scaled);
      return solver.get_cost() - solver.tryStep(1);
    };
    const double slope = (cost(h) - cost(-h)) / (2 * h);
    EXPECT_NEAR(slope, dot(g, nu), 1e-6 * std::abs(slope));
  }
  // Quu^-1 g is the backward pass's k
  solver.computeDirection(false);
  const Vectors k = solver.get_k();
  solver.preconditionFeedForward(g);
  for (std::size_t t = 0; t < g.size(); ++t) EXPECT_LT(error_of(g[t], k[t]), 1e-9) << t;
}

// ---- minima ---------------------------------------------------------------------------------------------------------

// 1/2 (2 + |x|^2)^2 + 1/2 |u|^2, x' = x + 0.1 u: the Hessian in x is 4 at x = 0, but zero in Gauss-Newton.
class Hollow : public ActionModelAbstract {
 public:
  explicit Hollow(double weight = 1) : ActionModelAbstract(std::make_shared<StateVector>(2), 2), weight_(weight) {}
  using ActionModelAbstract::calc;
  using ActionModelAbstract::calcDiff;
  void calc(const NodeDataPtr& d, const ConstVectorRef& x, const ConstVectorRef& u) override {
    calc(d, x);
    d->xnext = x + 0.1 * u;
    d->cost += 0.5 * u.squaredNorm();
  }
  void calc(const NodeDataPtr& d, const ConstVectorRef& x) override {
    const double r = 2 + x.squaredNorm();
    d->xnext = x;
    d->cost = weight_ * 0.5 * r * r;
  }
  void calcDiff(const NodeDataPtr& d, const ConstVectorRef& x, const ConstVectorRef& u) override {
    calcDiff(d, x);
    d->Fx.setIdentity();
    d->Fu = 0.1 * Eigen::Matrix2d::Identity();
    d->Lu = u;
    d->Luu.setIdentity();
  }
  void calcDiff(const NodeDataPtr& d, const ConstVectorRef& x) override {
    d->Lx = weight_ * 2 * (2 + x.squaredNorm()) * x;
    d->Lxx = weight_ * 4 * x * x.transpose();
  }

 private:
  double weight_;
};

std::shared_ptr<ShootingProblem> hollow(double limit) {
  const auto node = std::make_shared<Hollow>(10);
  node->set_u_lb(Eigen::Vector2d::Constant(-limit));
  node->set_u_ub(Eigen::Vector2d::Constant(limit));
  return std::make_shared<ShootingProblem>(Eigen::Vector2d(0.6, -0.2), std::vector<NodePtr>(8, node), node);
}

// Starts from a rollout of small controls, with three steps of the solver.
void start(SolverDDP& solver, std::size_t steps = 3) {
  ShootingProblem& problem = *solver.get_problem();
  Vectors us;
  for (const auto& model : problem.get_runningModels())
    us.emplace_back(Eigen::VectorXd::Constant(static_cast<Eigen::Index>(model->get_nu()), 0.1));
  solver.solve(problem.rollout_us(us), us, steps, true);
}

double residual_at(SolverDDP& solver) {
  const auto l =
      least_squares_multipliers(*solver.get_problem(), solver.get_xs(), solver.get_us(), solver.keeps_limits());
  return kkt_residual(*solver.get_problem(), solver.get_xs(), solver.get_us(), l, solver.keeps_limits());
}

TEST(FeedForward, DescendsWhereGaussNewtonDoesNotContract) {
  SolverFDDP newton(hollow(INFINITY)), quasi(hollow(INFINITY));
  newton.set_th_stop(1e-20);
  quasi.set_th_stop(1e-20);
  start(newton, 40);
  start(quasi);
  const auto log = std::make_shared<CallbackLogger>();
  quasi.setCallbacks({log});
  EXPECT_EQ(quasi.descend(40), StopReason::kConverged) << to_string(quasi.reason());
  EXPECT_LT(residual_at(quasi), 1e-8);
  EXPECT_GT(residual_at(newton), 1e-6);
  EXPECT_LE(quasi.get_cost(), newton.get_cost());
  for (std::size_t k = 1; k < log->costs.size(); ++k) EXPECT_LE(log->costs[k], log->costs[k - 1] + 1e-12) << k;
}

TEST(FeedForward, KeepsLimits) {
  SolverBoxFDDP solver(hollow(1.5));
  solver.set_th_stop(1e-20);
  start(solver);
  ASSERT_TRUE(solver.get_is_feasible());
  for (int k = 0; k < 5 && solver.descend(40) != StopReason::kConverged; ++k) {
  }
  EXPECT_LT(residual_at(solver), 1e-8) << to_string(solver.reason());
  int at_limit = 0;
  for (const Eigen::VectorXd& u : solver.get_us()) {
    EXPECT_LE(u.lpNorm<Eigen::Infinity>(), 1.5);
    at_limit += static_cast<int>((u.array().abs() == 1.5).count());
  }
  EXPECT_GT(at_limit, 0);
  EXPECT_LT(at_limit, 16);
}

// Several parts form one problem: sums over parts are the whole's, and so are the steps.
TEST(FeedForward, OfSeparatePartsTakesTheStepsOfTheWhole) {
  for (const double limit : {double(INFINITY), 1.5}) {
    SCOPED_TRACE(limit);
    const auto problem = [=](MatrixStorage storage) {
      const auto node = [=](double weight) {
        auto model = std::make_shared<Hollow>(weight);
        model->set_u_lb(Eigen::Vector2d::Constant(-limit));
        model->set_u_ub(Eigen::Vector2d::Constant(limit));
        return model;
      };
      std::vector<ActionPart> parts{{node(10), {0, 2}, {0, 2}, {0, 2}}, {node(5), {1, 3}, {1, 3}, {1, 3}}};
      const auto whole = std::make_shared<ActionModelParts>(std::make_shared<StateVector>(4), 4, std::move(parts));
      whole->set_storage(storage);
      return std::make_shared<ShootingProblem>(Eigen::Vector4d(0.6, -0.2, 0.1, 0.8), std::vector<NodePtr>(8, whole),
                                               whole);
    };
    const auto descended = [&](SolverDDP& solver) {
      const auto log = std::make_shared<CallbackLogger>();
      solver.set_th_stop(1e-18);
      start(solver);
      solver.setCallbacks({log});
      solver.descend(25);
      EXPECT_GT(log->costs.size(), 5u);
      return log;
    };
    SolverSparse sparse(problem(MatrixStorage::kSparse), limit < INFINITY);
    std::unique_ptr<SolverFDDP> dense;
    if (limit < INFINITY)
      dense = std::make_unique<SolverBoxFDDP>(problem(MatrixStorage::kDense));
    else
      dense = std::make_unique<SolverFDDP>(problem(MatrixStorage::kDense));
    const auto a = descended(*dense), b = descended(sparse);
    ASSERT_EQ(a->costs.size(), b->costs.size());
    for (std::size_t k = 0; k < a->costs.size(); ++k) EXPECT_NEAR(a->costs[k], b->costs[k], 1e-9 * a->costs[k]) << k;
    for (std::size_t t = 0; t < dense->get_us().size(); ++t)
      EXPECT_LT((dense->get_us()[t] - sparse.get_us()[t]).norm(), 1e-7) << t;
  }
}

TEST(FeedForward, RefusesACandidateWithGaps) {
  SolverFDDP solver(hollow(INFINITY));
  EXPECT_THROW((void)solver.descend(1), std::invalid_argument);
}

}  // namespace
}  // namespace manycontact::test
