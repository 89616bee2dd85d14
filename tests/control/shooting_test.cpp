// ShootingProblem has sums, rollouts, replaced nodes; LQR and unicycle agree with numerical differentiation.

#include <atomic>
#include <chrono>
#include <sstream>
#include <thread>

#include "control/nodes.hpp"
#include "support/sanitized.hpp"

namespace manycontact::test {
namespace {

using Vectors = std::vector<Eigen::VectorXd>;

NodePtr lqr(std::size_t nx = 4, std::size_t nu = 2) {
  return std::make_shared<ActionModelLQR>(ActionModelLQR::Random(nx, nu));
}

TEST(Shooting, CalcAddsUpTheNodes) {
  const std::vector<NodePtr> nodes = {lqr(), lqr(), lqr()};
  const NodePtr terminal = lqr();
  std::mt19937 rng(1);
  ShootingProblem problem(random_vector(4, rng), nodes, terminal);
  Vectors xs, us;
  for (int t = 0; t < 4; ++t) xs.push_back(random_vector(4, rng));
  for (int t = 0; t < 3; ++t) us.push_back(random_vector(2, rng));
  double cost = 0;
  for (int t = 0; t < 3; ++t) {
    const auto data = nodes[t]->createData();
    nodes[t]->calc(data, xs[t], us[t]);
    cost += data->cost;
  }
  const auto data = terminal->createData();
  terminal->calc(data, xs[3]);
  cost += data->cost;
  EXPECT_EQ(problem.calc(xs, us), cost);
  EXPECT_EQ(problem.calcDiff(xs, us), cost);
  problem.rollout(us, xs);
  EXPECT_TRUE(xs[0] == problem.get_x0());
  EXPECT_TRUE(problem.rollout_us(us)[3] == xs[3]);
  EXPECT_TRUE(problem.get_runningDatas()[1]->xnext == xs[2]);
  std::ostringstream text;
  text << problem;
  EXPECT_NE(text.str().find("T=3"), std::string::npos);
}

// A node that records which thread evaluates it, and takes some time.
class Noted : public ActionModelUnicycle {
 public:
  explicit Noted(double seconds) : seconds_(seconds) {}
  void calc(const NodeDataPtr& data, const ConstVectorRef& x, const ConstVectorRef& u) override {
    ActionModelUnicycle::calc(data, x, u);
    if (std::this_thread::get_id() != caller_) ++by_others;
    const auto begin = std::chrono::steady_clock::now();
    while (std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count() < seconds_) {
    }
  }
  using ActionModelUnicycle::calc;
  std::atomic<int> by_others = 0;

 private:
  double seconds_;
  std::thread::id caller_ = std::this_thread::get_id();
};

// A loop that other programs once delayed counts as a long one: not every call is made by one thread.
TEST(Shooting, ThreadsAreNotCalledForNextToNothing) {
  if (kSanitized) GTEST_SKIP() << "nothing takes next to no time under sanitizers";
  constexpr std::size_t T = 300;
  const Vectors xs(T + 1, Eigen::Vector3d(1, 0, 0)), us(T, Eigen::Vector2d(0.1, 0.1));
  for (const double seconds : {0.0, 1e-5}) {
    const auto node = std::make_shared<Noted>(seconds);
    ShootingProblem problem(xs[0], std::vector<NodePtr>(T, node), node);
    problem.set_nthreads(2);
    const double cost = problem.calc(xs, us);
    const bool has_threads = node->by_others > 0;
    node->by_others = 0;
    for (int k = 0; k < 20; ++k) EXPECT_EQ(problem.calc(xs, us), cost);
    const int all = 20 * static_cast<int>(T);
    if (seconds == 0) {
      EXPECT_LT(node->by_others, all / 10);
    } else if (has_threads) {
      EXPECT_GT(node->by_others, all / 4);
    }
  }
}

TEST(Shooting, NodesAreReplaced) {
  const std::vector<NodePtr> nodes = {lqr(), lqr(), lqr()};
  ShootingProblem problem(Eigen::VectorXd::Zero(4), nodes, lqr());
  EXPECT_FALSE(problem.is_updated());
  const NodePtr fresh = lqr(4, 3);
  problem.circularAppend(fresh);
  EXPECT_TRUE(problem.is_updated());
  EXPECT_FALSE(problem.is_updated());
  EXPECT_EQ(problem.get_runningModels()[0], nodes[1]);
  EXPECT_EQ(problem.get_runningModels()[2], fresh);
  EXPECT_EQ(problem.get_runningDatas()[2]->Fu.cols(), 3);
  EXPECT_EQ(problem.get_nu_max(), 3u);
  problem.updateModel(3, fresh);
  EXPECT_EQ(problem.get_terminalModel(), fresh);
  problem.updateNode(0, fresh, fresh->createData());
  EXPECT_EQ(problem.get_runningModels()[0], fresh);
  problem.set_runningModels({nodes[0], nodes[1]});
  EXPECT_EQ(problem.get_T(), 2u);
  EXPECT_THROW(problem.updateModel(4, fresh), std::invalid_argument);
  EXPECT_THROW(problem.updateModel(0, lqr(5, 2)), std::invalid_argument);
  EXPECT_THROW(problem.updateModel(0, nullptr), std::invalid_argument);
  EXPECT_THROW(problem.set_x0(Eigen::VectorXd::Zero(3)), std::invalid_argument);
  EXPECT_THROW(problem.calc(Vectors(2), Vectors(2)), std::invalid_argument);
  EXPECT_THROW(ShootingProblem(Eigen::VectorXd::Zero(4), {}, fresh), std::invalid_argument);
  EXPECT_THROW(ShootingProblem(Eigen::VectorXd::Zero(3), nodes, fresh), std::invalid_argument);
  EXPECT_THROW(ShootingProblem(Eigen::VectorXd::Zero(4), nodes, nullptr), std::invalid_argument);
}

// A solver follows a problem when its nodes, their controls and their number change.
TEST(Shooting, ASolverFollowsReplacedNodes) {
  const auto problem =
      std::make_shared<ShootingProblem>(Eigen::VectorXd::Ones(4), std::vector<NodePtr>(3, lqr()), lqr());
  SolverFDDP solver(problem);
  EXPECT_TRUE(solver.solve());
  const auto expect_solved_as_afresh = [&] {
    EXPECT_TRUE(solver.solve());
    SolverFDDP afresh(problem);
    EXPECT_TRUE(afresh.solve());
    EXPECT_EQ(solver.get_cost(), afresh.get_cost());
    EXPECT_EQ(solver.get_us(), afresh.get_us());
  };
  problem->circularAppend(lqr(4, 3));
  expect_solved_as_afresh();
  problem->set_runningModels(std::vector<NodePtr>(5, lqr(4, 1)));
  expect_solved_as_afresh();
}

TEST(Shooting, QuasiStaticHoldsTheHumanoid) {
  const auto problem = reaching_humanoid(3);
  for (const int threads : {1, 2}) {
    problem->set_nthreads(threads);
    const Guess guess = standing(*problem);
    const Vectors xs = problem->rollout_us(guess.us);
    EXPECT_LT(size_of((xs.back() - xs.front()).eval()), 1e-8);
  }
}

template <class Model>
void expect_like_its_twin(const std::shared_ptr<Model>& model, double tolerance) {
  std::mt19937 rng(6);
  ActionModelNumDiff twin(model);
  const Eigen::VectorXd x = random_vector(static_cast<int>(model->get_state()->get_nx()), rng);
  const Eigen::VectorXd u = random_vector(static_cast<int>(model->get_nu()), rng);
  const NodeDataPtr data = model->createData(), numbers = twin.createData();
  for (const bool terminal : {false, true}) {
    if (terminal) {
      model->calc(data, x), model->calcDiff(data, x);
      twin.calc(numbers, x), twin.calcDiff(numbers, x);
    } else {
      model->calc(data, x, u), model->calcDiff(data, x, u);
      twin.calc(numbers, x, u), twin.calcDiff(numbers, x, u);
      EXPECT_LT(error_of(data->Fx, numbers->Fx), tolerance);
      EXPECT_LT(error_of(data->Fu, numbers->Fu), tolerance);
      EXPECT_LT(error_of(data->Lu, numbers->Lu), tolerance);
      EXPECT_LT(difference_of(data->Lxu, numbers->Lxu), 100 * tolerance * size_of(data->Lxx));
      EXPECT_LT(error_of(data->Luu, numbers->Luu), 100 * tolerance);
      EXPECT_LT(error_of(data->Gu, numbers->Gu), tolerance);
      EXPECT_LT(error_of(data->Hu, numbers->Hu), tolerance);
    }
    EXPECT_LT(error_of(data->Lx, numbers->Lx), tolerance);
    EXPECT_LT(error_of(data->Lxx, numbers->Lxx), 100 * tolerance);
    EXPECT_LT(error_of(data->Gx, numbers->Gx), tolerance);
    EXPECT_LT(error_of(data->Hx, numbers->Hx), tolerance);
  }
}

TEST(Models, AreLikeTheirTwins) {
  expect_like_its_twin(std::make_shared<ActionModelUnicycle>(), 1e-7);
  expect_like_its_twin(std::make_shared<ActionModelLQR>(ActionModelLQR::Random(4, 3, 2, 1)), 1e-7);
  expect_like_its_twin(std::make_shared<ActionModelLQR>(3, 2, false), 1e-7);
}

TEST(Models, LqrRefusesMisuse) {
  const Eigen::MatrixXd I = Eigen::MatrixXd::Identity(2, 2), Z = Eigen::MatrixXd::Zero(2, 2);
  EXPECT_NO_THROW(ActionModelLQR(I, I, I, I, Z));
  EXPECT_THROW(ActionModelLQR(I, I, -I, I, Z), std::invalid_argument);
  EXPECT_THROW(ActionModelLQR(I, Eigen::MatrixXd::Identity(3, 2), I, I, Z), std::invalid_argument);
  EXPECT_THROW(DifferentialActionModelLQR(I, I, I, I, I, Z), std::invalid_argument);
  EXPECT_THROW(ActionModelUnicycle().set_dt(0), std::invalid_argument);
}

TEST(Models, FreeForwardDynamicsHasNoContacts) {
  Walker w;
  DifferentialActionModelFreeFwdDynamics model(w.state, w.actuation, w.costs);
  const auto data = model.createData();
  model.calc(data, w.x_rest, Eigen::VectorXd::Zero(w.nu));
  EXPECT_NEAR(data->xout[2], -9.81, 1e-9);  // it falls
  EXPECT_THROW(DifferentialActionModelFreeFwdDynamics(w.state, nullptr, w.costs), std::invalid_argument);
}

// The state satisfies the laws of Crocoddyl's tests of states.
TEST(Models, StateVectorIsAVectorSpace) {
  const StateVector state(3);
  const Eigen::VectorXd x0 = state.rand(), x1 = state.rand();
  EXPECT_TRUE(state.diff_dx(x0, x1) == x1 - x0);
  EXPECT_LT(size_of((state.integrate_x(x0, state.diff_dx(x0, x1)) - x1).eval()), 1e-15);
  EXPECT_TRUE(state.Jdiff_Js(x0, x1)[0] == -Eigen::MatrixXd::Identity(3, 3));
  EXPECT_TRUE(state.Jintegrate_Js(x0, x1)[1] == Eigen::MatrixXd::Identity(3, 3));
  EXPECT_EQ(state.get_ndx(), 3u);
}

}  // namespace
}  // namespace manycontact::test
