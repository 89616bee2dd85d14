// Nodes have parts that never meet, and FDDP works by parts.

#include "control/nodes.hpp"
#include "manycontact/control/riccati_direction.hpp"
#include "support/allocations.hpp"

namespace manycontact::test {
namespace {

using Vectors = std::vector<Eigen::VectorXd>;

std::vector<int> every_other(int first, int count) {
  std::vector<int> out;
  for (int i = 0; i < count; ++i) out.push_back(first + 2 * i);
  return out;
}

// Returns three unicycles: two with interleaved coordinates of the node, the last behind them, with limits of controls.
std::vector<ActionPart> three_unicycles(double limit = INFINITY) {
  std::vector<ActionPart> parts(3);
  for (ActionPart& part : parts) {
    part.model = std::make_shared<ActionModelUnicycle>();
    part.model->set_u_lb(Eigen::Vector2d::Constant(-limit));
    part.model->set_u_ub(Eigen::Vector2d::Constant(limit));
  }
  for (int i : {0, 1}) {
    parts[i].x = parts[i].dx = every_other(i, 3);
    parts[i].u = every_other(i, 2);
  }
  parts[2].x = parts[2].dx = {8, 6, 7};
  parts[2].u = {4, 5};
  return parts;
}

std::shared_ptr<ActionModelParts> node(MatrixStorage storage, double limit = INFINITY) {
  auto model = std::make_shared<ActionModelParts>(std::make_shared<StateVector>(9), 6, three_unicycles(limit));
  model->set_storage(storage);
  return model;
}

std::shared_ptr<ShootingProblem> unicycles(MatrixStorage storage, std::size_t T = 20, double limit = INFINITY) {
  Eigen::VectorXd x0(9);
  x0 << 1, -1, 0.5, 1, 2, 0.3, 0.4, -0.7, 2;
  const auto problem =
      std::make_shared<ShootingProblem>(x0, std::vector<NodePtr>(T, node(storage, limit)), node(storage));
  problem->set_nthreads(1);
  return problem;
}

Vectors random_vectors(std::size_t count, int size, int seed) {
  std::mt19937 rng(seed);
  Vectors out;
  for (std::size_t k = 0; k < count; ++k) out.push_back(random_vector(size, rng));
  return out;
}

TEST(Parts, DerivativesOfANode) {
  const auto model = node(MatrixStorage::kDense);
  ActionModelNumDiff twin(model);
  const NodeDataPtr data = model->createData(), other = twin.createData();
  std::mt19937 rng(3);
  const Eigen::VectorXd x = random_vector(9, rng), u = random_vector(6, rng);
  model->calc(data, x, u);
  model->calcDiff(data, x, u);
  twin.calc(other, x, u);
  twin.calcDiff(other, x, u);
  EXPECT_EQ(data->cost, other->cost);
  EXPECT_EQ(data->xnext, other->xnext);
  EXPECT_LT(error_of(data->Fx, other->Fx), 1e-8);
  EXPECT_LT(error_of(data->Fu, other->Fu), 1e-8);
  EXPECT_LT(error_of(data->Lx, other->Lx), 1e-8);
  EXPECT_LT(error_of(data->Lu, other->Lu), 1e-8);
  EXPECT_NE(data->Fx(0, 4), 0);
  EXPECT_EQ(data->Fx(0, 1), 0);
}

TEST(Parts, RefuseCoordinatesOfNoneOrOfTwo) {
  const auto state = std::make_shared<StateVector>(9);
  std::vector<ActionPart> parts = three_unicycles();
  parts[2].x[0] = 6;
  EXPECT_THROW(ActionModelParts(state, 6, parts), std::invalid_argument);
  parts = three_unicycles();
  parts.pop_back();
  EXPECT_THROW(ActionModelParts(state, 6, parts), std::invalid_argument);
  EXPECT_THROW(ActionModelParts(state, 7, three_unicycles()), std::invalid_argument);
  EXPECT_THROW(ActionModelParts(state, 6, {}), std::invalid_argument);
  EXPECT_THROW(node(MatrixStorage::kDense)->set_storage(MatrixStorage::kBoth), std::invalid_argument);
}

TEST(SolverSparse, DirectionsAreTheDenseOnes) {
  SolverFDDP dense(unicycles(MatrixStorage::kDense));
  SolverSparse sparse(unicycles(MatrixStorage::kSparse));
  ASSERT_EQ(sparse.directions().size(), 3u);
  const Vectors xs = random_vectors(21, 9, 4), us = random_vectors(20, 6, 5);
  for (SolverAbstract* solver : {static_cast<SolverAbstract*>(&dense), static_cast<SolverAbstract*>(&sparse)}) {
    solver->setCandidate(xs, us, false);
    solver->set_preg(1e-3);
    solver->computeDirection(true);
  }
  for (const auto& direction : sparse.directions()) {
    const auto* own = dynamic_cast<const RiccatiDirection*>(direction.get());
    ASSERT_NE(own, nullptr);
    const ShootingPart& part = own->part();
    for (std::size_t t = 0; t < 20; ++t) {
      const std::vector<int>& u = part.u[t];
      EXPECT_LT(error_of(own->get_k()[t], Eigen::VectorXd(dense.get_k()[t](u))), 1e-12);
      EXPECT_LT(error_of(own->get_K()[t], Eigen::MatrixXd(dense.get_K()[t](u, part.dx))), 1e-12);
      EXPECT_LT(error_of(own->get_Vx()[t], Eigen::VectorXd(dense.get_Vx()[t](part.dx))), 1e-12);
    }
    for (const auto* none : {&own->get_Vxx(), &own->get_Qxx(), &own->get_Qxu(), &own->get_Quu()})
      for (const Eigen::MatrixXd& hessian : *none) EXPECT_EQ(hessian.size(), 0);
  }
}

TEST(SolverDDP, GainsAreOfTheNodeAtHand) {
  SolverFDDP solver(unicycles(MatrixStorage::kDense));
  EXPECT_THROW(solver.computeGains(3), std::invalid_argument);
  solver.computeDirection(true);  // ends with node 0
  EXPECT_THROW(solver.computeGains(3), std::invalid_argument);
  EXPECT_THROW(solver.computeValueFunction(3, solver.get_problem()->get_runningModels()[3]), std::invalid_argument);
  const Eigen::VectorXd k = solver.get_k()[3];
  solver.computeActionValueFunction(3, solver.get_problem()->get_runningModels()[3],
                                    solver.get_problem()->get_runningDatas()[3]);
  solver.computeGains(3);
  EXPECT_LT(error_of(solver.get_k()[3], k), 1e-12);
}

TEST(SolverSparse, DataOfPartsHaveNoMatrices) {
  const auto problem = unicycles(MatrixStorage::kSparse);
  const ActionDataAbstract& data = *problem->get_runningDatas()[0];
  EXPECT_FALSE(data.has_matrices());
  Eigen::VectorXd gx(9), gu(6);
  Eigen::MatrixXd fx, fu;
  EXPECT_THROW(data.pull_back(Eigen::VectorXd::Zero(9), gx, gu), std::logic_error);
  EXPECT_THROW(data.dynamics(fx, fu), std::logic_error);
}

TEST(SolverSparse, PartsWithLimitsKeepTheirHessians) {
  SolverBoxFDDP dense(unicycles(MatrixStorage::kDense, 20, 1.2));
  SolverSparse sparse(unicycles(MatrixStorage::kSparse, 20, 1.2), true);
  const Vectors xs = random_vectors(21, 9, 4), us = random_vectors(20, 6, 5);
  for (SolverAbstract* solver : {static_cast<SolverAbstract*>(&dense), static_cast<SolverAbstract*>(&sparse)}) {
    solver->setCandidate(xs, us, false);
    solver->set_preg(1e-3);
    solver->computeDirection(true);
  }
  for (const auto& direction : sparse.directions())
    for (std::size_t t = 0; t <= 20; ++t) {
      const auto& own = dynamic_cast<const RiccatiDirection&>(*direction);
      const std::vector<int>& dx = own.part().dx;
      EXPECT_LT(error_of(own.get_Vxx()[t], Eigen::MatrixXd(dense.get_Vxx()[t](dx, dx))), 1e-12);
    }
}

void expect_the_same_iterates(SolverFDDP& dense, SolverSparse& sparse) {
  const auto dense_log = std::make_shared<CallbackLogger>(), sparse_log = std::make_shared<CallbackLogger>();
  dense.setCallbacks({dense_log});
  sparse.setCallbacks({sparse_log});
  const Vectors xs = random_vectors(21, 9, 6), us = random_vectors(20, 6, 7);
  EXPECT_TRUE(dense.solve(xs, us));
  EXPECT_TRUE(sparse.solve(xs, us));
  EXPECT_EQ(sparse.reason(), StopReason::kConverged);
  ASSERT_EQ(sparse_log->costs.size(), dense_log->costs.size());
  EXPECT_GE(dense_log->costs.size(), 3u);
  EXPECT_EQ(sparse_log->steps, dense_log->steps);
  EXPECT_EQ(sparse_log->pregs, dense_log->pregs);
  EXPECT_EQ(sparse_log->feasible, dense_log->feasible);
  for (std::size_t k = 0; k < dense_log->costs.size(); ++k)
    EXPECT_LT(std::abs(sparse_log->costs[k] - dense_log->costs[k]), 1e-9 * dense_log->costs[k]);
  for (std::size_t t = 0; t <= 20; ++t) EXPECT_LT(difference_of(sparse.get_xs()[t], dense.get_xs()[t]), 1e-9);
  for (std::size_t t = 0; t < 20; ++t) EXPECT_LT(difference_of(sparse.get_us()[t], dense.get_us()[t]), 1e-9);
}

TEST(SolverSparse, IteratesAreFDDPs) {
  SolverFDDP dense(unicycles(MatrixStorage::kDense));
  SolverSparse sparse(unicycles(MatrixStorage::kSparse));
  expect_the_same_iterates(dense, sparse);
}

// The box QP of three is that of each; a QP ends with a Newton step on its free controls, exact up to rounding.
TEST(SolverSparse, IteratesWithLimitsAreBoxFDDPs) {
  SolverBoxFDDP dense(unicycles(MatrixStorage::kDense, 20, 1.2));
  SolverSparse sparse(unicycles(MatrixStorage::kSparse, 20, 1.2), true);
  expect_the_same_iterates(dense, sparse);
  EXPECT_EQ(sparse.get_th_stop(), dense.get_th_stop());
  int at_limit = 0;
  for (const Eigen::VectorXd& u : sparse.get_us()) {
    EXPECT_LE(u.lpNorm<Eigen::Infinity>(), 1.2);
    at_limit += static_cast<int>((u.array().abs() == 1.2).count());
  }
  EXPECT_GT(at_limit, 5);
  SolverSparse free(unicycles(MatrixStorage::kSparse, 20, 1.2));
  EXPECT_TRUE(free.solve());
  EXPECT_LT(free.get_cost(), sparse.get_cost());
}

TEST(SolverSparse, OnePartGivesTheBitsOfFDDP) {
  const auto problem = reaching_humanoid(7);
  const Guess guess = standing(*problem);
  SolverFDDP dense(problem);
  dense.solve(guess.xs, guess.us, 5);
  const Vectors xs = dense.get_xs(), us = dense.get_us();
  SolverSparse sparse(problem);
  sparse.solve(guess.xs, guess.us, 5);
  EXPECT_EQ(sparse.blocks(), (std::vector<int>{static_cast<int>(problem->get_nu_max())}));
  EXPECT_EQ(sparse.get_cost(), dense.get_cost());
  EXPECT_EQ(sparse.get_stop(), dense.get_stop());
  EXPECT_TRUE(sparse.get_xs() == xs);
  EXPECT_TRUE(sparse.get_us() == us);
}

TEST(SolverSparse, FollowsReplacedNodesAndStates) {
  const auto problem = unicycles(MatrixStorage::kSparse, 8);
  SolverSparse sparse(problem);
  sparse.solve();
  problem->circularAppend(node(MatrixStorage::kSparse));
  problem->set_x0(Eigen::VectorXd::Constant(9, 0.4));
  EXPECT_TRUE(sparse.solve());
  EXPECT_EQ(sparse.get_xs()[0], problem->get_x0());
  const auto fresh = unicycles(MatrixStorage::kDense, 8);
  fresh->set_x0(problem->get_x0());
  SolverFDDP dense(fresh);
  EXPECT_TRUE(dense.solve());
  EXPECT_LT(std::abs(sparse.get_cost() - dense.get_cost()), 1e-9 * dense.get_cost());
}

TEST(SolverSparse, TakesNoMemoryInItsIterations) {
  if (!MANYCONTACT_COUNTS_ALLOCATIONS) GTEST_SKIP() << "malloc cannot be counted here";
  const auto problem = unicycles(MatrixStorage::kSparse);
  problem->set_nthreads(1);
  const auto limited = unicycles(MatrixStorage::kSparse, 20, 1.2);
  limited->set_nthreads(1);
  SolverSparse solver(problem), box(limited, true);
  const Vectors xs = random_vectors(21, 9, 6), us = random_vectors(20, 6, 7);
  for (SolverSparse* own : {&solver, &box}) {
    own->solve(xs, us, 5);
    EXPECT_EQ(allocations([&] { own->solve(xs, us, 5); }), 0u);
  }
}

TEST(SolverSparse, RefusesWhatItCannotTakeApart) {
  EXPECT_THROW(SolverFDDP(unicycles(MatrixStorage::kSparse)), std::invalid_argument);
  const auto some = unicycles(MatrixStorage::kSparse);
  std::vector<ActionPart> other = three_unicycles();
  std::swap(other[0].dx, other[1].dx);
  some->updateModel(3, std::make_shared<ActionModelParts>(std::make_shared<StateVector>(9), 6, other));
  EXPECT_THROW(SolverSparse{some}, std::invalid_argument);
  some->updateModel(3, std::make_shared<ActionModelLQR>(9, 6));
  EXPECT_THROW(SolverSparse{some}, std::invalid_argument);
}

// A part without controls moves by its own dynamics, alone as well as in the whole.
TEST(SolverSparse, MovesPartsWithoutControls) {
  std::vector<ActionPart> parts = three_unicycles();
  const Eigen::MatrixXd A = Eigen::Vector3d(1.1, 0.9, 1).asDiagonal(), Q = Eigen::MatrixXd::Identity(3, 3), B(3, 0),
                        R(0, 0), N(3, 0);
  parts[2].model = std::make_shared<ActionModelLQR>(A, B, Q, R, N);
  parts[2].u.clear();
  Eigen::VectorXd x0(9);
  x0 << 1, -1, 0.5, 1, 2, 0.3, 0.4, -0.7, 2;
  const auto of = [&](MatrixStorage storage) {
    const auto model = std::make_shared<ActionModelParts>(std::make_shared<StateVector>(9), 4, parts);
    model->set_storage(storage);
    return std::make_shared<ShootingProblem>(x0, std::vector<NodePtr>(10, model), model);
  };
  SolverFDDP dense(of(MatrixStorage::kDense));
  SolverSparse sparse(of(MatrixStorage::kSparse));
  dense.solve(Vectors(11, x0), Vectors(10, Eigen::VectorXd::Zero(4)), 100);
  sparse.solve(Vectors(11, x0), Vectors(10, Eigen::VectorXd::Zero(4)), 100);
  const Eigen::VectorXd& last = sparse.get_xs().back();
  EXPECT_NEAR(last[8], 2 * std::pow(1.1, 10), 1e-12);  // the part's coordinates are 8, 6, 7
  EXPECT_NEAR(last[6], 0.4 * std::pow(0.9, 10), 1e-12);
  for (std::size_t t = 0; t <= 10; ++t) EXPECT_LT(error_of(sparse.get_xs()[t], dense.get_xs()[t]), 1e-9) << t;
}

}  // namespace
}  // namespace manycontact::test
