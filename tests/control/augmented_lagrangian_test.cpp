// Constrained problems are compared with the dense solution of the whole horizon; nonlinear ones must satisfy their
// optimality conditions, and infeasible ones must be reported.

#include "control/nodes.hpp"
#include "support/allocations.hpp"
#include "support/dense.hpp"
#include "support/scenes.hpp"

namespace manycontact::test {
namespace {

using Vectors = std::vector<Eigen::VectorXd>;
double residual_of(SolverAugmentedLagrangian& solver, bool limits = false) {
  return kkt_residual(*solver.get_problem(), solver.get_xs(), solver.get_us(), solver.get_dynamics_multipliers(),
                      limits, solver.get_multipliers());
}

// ---- linear-quadratic problems --------------------------------------------------------------------------------------

// The problem has one equality at each running node, two at the terminal one (x alone).
std::shared_ptr<ShootingProblem> constrained_lqr(std::size_t T, std::size_t nx, std::size_t nu) {
  std::vector<NodePtr> nodes;
  for (std::size_t t = 0; t < T; ++t)
    nodes.push_back(std::make_shared<ActionModelLQR>(ActionModelLQR::Random(nx, nu, 0, t % 2)));
  std::mt19937 rng(2);
  return std::make_shared<ShootingProblem>(random_vector(static_cast<int>(nx), rng), nodes,
                                           std::make_shared<ActionModelLQR>(ActionModelLQR::Random(nx, nu, 0, 2)));
}

// Returns [x_0; u_0; x_1; ...] of the KKT system with all equalities.
Eigen::VectorXd constrained_solution(ShootingProblem& problem) {
  const Eigen::Index T = problem.get_T(), nx = problem.get_nx(), nu = problem.get_nu_max(), n = nx + nu;
  const Eigen::Index nz = T * n + nx;
  Eigen::MatrixXd H = Eigen::MatrixXd::Zero(nz, nz), C = Eigen::MatrixXd::Zero(nx, nz);
  Eigen::VectorXd g = Eigen::VectorXd::Zero(nz), c = problem.get_x0();  // C z = c
  C.leftCols(nx).setIdentity();
  const auto append = [&](Eigen::Index rows) {
    C.conservativeResize(C.rows() + rows, nz);
    c.conservativeResize(c.size() + rows);
    C.bottomRows(rows).setZero();
  };
  for (Eigen::Index t = 0; t <= T; ++t) {
    const auto& m =
        dynamic_cast<ActionModelLQR&>(t < T ? *problem.get_runningModels()[t] : *problem.get_terminalModel());
    const Eigen::Index z = t * n, nh = m.get_h().size(), own = t < T ? n : nx;
    append(nh);
    C.block(C.rows() - nh, z, nh, own) = m.get_H().leftCols(own);
    c.tail(nh) = -m.get_h();
    H.block(z, z, nx, nx) = m.get_Q();
    g.segment(z, nx) = m.get_q();
    if (t == T) break;
    H.block(z, z + nx, nx, nu) = m.get_N();
    H.block(z + nx, z, nu, nx) = m.get_N().transpose();
    H.block(z + nx, z + nx, nu, nu) = m.get_R();
    g.segment(z + nx, nu) = m.get_r();
    append(nx);
    C.block(C.rows() - nx, z, nx, nx) = -m.get_A();
    C.block(C.rows() - nx, z + nx, nx, nu) = -m.get_B();
    C.block(C.rows() - nx, z + n, nx, nx).setIdentity();
    c.tail(nx) = m.get_f();
  }
  const Eigen::Index nc = C.rows();
  Eigen::MatrixXd K = Eigen::MatrixXd::Zero(nz + nc, nz + nc);
  K.topLeftCorner(nz, nz) = H;
  K.bottomLeftCorner(nc, nz) = C;
  K.topRightCorner(nz, nc) = C.transpose();
  Eigen::VectorXd b(nz + nc);
  b << -g, c;
  return least_norm(K, b).col(0).head(nz);
}

// Constraints are met to 1e-8 and the KKT residual is below 1e-7; the solution differs by that times the norm of the
// inverse KKT matrix, 5 to 50 here.
TEST(AugmentedLagrangian, SolvesALinearQuadraticProblemWithEqualities) {
  const auto problem = constrained_lqr(6, 4, 3);
  const Eigen::VectorXd truth = constrained_solution(*problem);
  SolverAugmentedLagrangian solver(problem);
  EXPECT_TRUE(solver.solve()) << to_string(solver.reason());
  EXPECT_LT(error_of(stacked(solver), truth), 1e-6);
  EXPECT_LE(solver.get_violation(), 1e-8);
  EXPECT_LE(solver.get_hfeas(), 1e-8);
  EXPECT_LT(residual_of(solver), 1e-7);
  EXPECT_NEAR(solver.get_cost(), problem->calc(solver.get_xs(), solver.get_us()), 1e-12 * std::abs(solver.get_cost()));
  // without constraints the solution is another one
  SolverFDDP fddp(problem);
  EXPECT_TRUE(fddp.solve());
  EXPECT_GT(error_of(stacked(fddp), truth), 1e-2);
}

TEST(AugmentedLagrangian, SolvesAProblemWithoutConstraints) {
  const auto node = std::make_shared<ActionModelUnicycle>();
  const auto problem =
      std::make_shared<ShootingProblem>(Eigen::Vector3d(-1, -1, 1), std::vector<NodePtr>(20, node), node);
  SolverAugmentedLagrangian solver(problem);
  SolverFDDP fddp(problem);
  EXPECT_TRUE(solver.solve());
  EXPECT_TRUE(fddp.solve());
  EXPECT_NEAR(solver.get_cost(), fddp.get_cost(), 1e-9 * fddp.get_cost());
  EXPECT_EQ(solver.get_inner()->get_problem()->get_runningModels()[0], node);
}

// ---- a unicycle through a gate --------------------------------------------------------------------------------------

// Imposes lower <= y <= upper, and x = goal if it is given.
class Gate : public ActionModelUnicycle {
 public:
  Gate(double lower, double upper, double goal = NAN) : goal_(goal) {
    ng_ = ng_T_ = 1;
    nh_ = nh_T_ = std::isnan(goal) ? 0 : 1;
    g_lb_ = Eigen::VectorXd::Constant(1, lower);
    g_ub_ = Eigen::VectorXd::Constant(1, upper);
  }
  void calc(const NodeDataPtr& data, const ConstVectorRef& x, const ConstVectorRef& u) override {
    ActionModelUnicycle::calc(data, x, u);
    constrain(*data, x);
  }
  void calc(const NodeDataPtr& data, const ConstVectorRef& x) override {
    ActionModelUnicycle::calc(data, x);
    constrain(*data, x);
  }
  using ActionModelUnicycle::calcDiff;
  void calcDiff(const NodeDataPtr& data, const ConstVectorRef& x) override {
    ActionModelUnicycle::calcDiff(data, x);
    data->Gx << 0, 1, 0;
    if (nh_ > 0) data->Hx << 1, 0, 0;
  }

 private:
  void constrain(ActionDataAbstract& d, const ConstVectorRef& x) const {
    d.g[0] = x[1];
    if (nh_ > 0) d.h[0] = x[0] - goal_;
  }
  double goal_;
};

std::shared_ptr<ShootingProblem> gated(const std::shared_ptr<ActionModelUnicycle>& gate) {
  const auto node = std::make_shared<ActionModelUnicycle>();
  std::vector<NodePtr> nodes(20, node);
  nodes[10] = gate;
  return std::make_shared<ShootingProblem>(Eigen::Vector3d(-1, -1, 1), nodes, node);
}

TEST(AugmentedLagrangian, AUnicyclePassesAGate) {
  SolverFDDP free(gated(std::make_shared<ActionModelUnicycle>()));
  ASSERT_TRUE(free.solve());
  const double y = free.get_xs()[10][1];
  struct Case {
    double lower, upper;
    int sign;  // of the multiplier
  };
  for (const Case& c : {Case{y + 0.1, y + 0.5, -1},
                        {y - 0.5, y - 0.1, 1},
                        {y - 0.1, y + 0.1, 0},
                        {-kInfinity, y - 0.12, 1},
                        {y + 0.12, y + 0.12, -1}}) {
    SCOPED_TRACE(testing::Message() << c.lower << " to " << c.upper);
    SolverAugmentedLagrangian solver(gated(std::make_shared<Gate>(c.lower, c.upper)));
    EXPECT_TRUE(solver.solve({}, {}, 200)) << to_string(solver.reason());
    const double passed = solver.get_xs()[10][1], multiplier = solver.get_multipliers()[10][0];
    EXPECT_GE(passed, c.lower - 1e-8);
    EXPECT_LE(passed, c.upper + 1e-8);
    EXPECT_LT(residual_of(solver), 1e-6);
    EXPECT_LE(solver.get_gfeas(), 1e-8);
    if (c.sign == 0) {
      EXPECT_EQ(multiplier, 0);
      EXPECT_NEAR(solver.get_cost(), free.get_cost(), 1e-9 * free.get_cost());
    } else {
      EXPECT_GT(c.sign * multiplier, 1e-3);
      EXPECT_NEAR(passed, c.sign > 0 ? c.upper : c.lower, 1e-8);
      EXPECT_GT(solver.get_cost(), free.get_cost());
    }
  }
}

// The multiplier is the rate at which the optimal cost falls when the bound moves: d cost / d upper = - y.
TEST(AugmentedLagrangian, MultipliersAreTheSlopeOfTheCost) {
  const auto solved = [&](double upper) {
    auto solver = std::make_unique<SolverAugmentedLagrangian>(gated(std::make_shared<Gate>(-kInfinity, upper)));
    EXPECT_TRUE(solver->solve({}, {}, 200));
    return solver;
  };
  constexpr double upper = -0.12, h = 1e-4;
  const double slope = (solved(upper + h)->get_cost() - solved(upper - h)->get_cost()) / (2 * h);
  const double y = solved(upper)->get_multipliers()[10][0];
  EXPECT_GT(y, 1);
  EXPECT_NEAR(slope, -y, 1e-5 * y);
}

TEST(AugmentedLagrangian, KeepsControlLimitsToo) {
  const auto node = std::make_shared<ActionModelUnicycle>();
  const auto gate = std::make_shared<Gate>(-0.45, kInfinity, -0.6);
  for (ActionModelUnicycle* model : {node.get(), static_cast<ActionModelUnicycle*>(gate.get())}) {
    model->set_u_lb(Eigen::Vector2d(-1, -1.5));
    model->set_u_ub(Eigen::Vector2d(1, 1.5));
  }
  std::vector<NodePtr> nodes(20, node);
  nodes[10] = gate;
  SolverAugmentedLagrangian solver(std::make_shared<ShootingProblem>(Eigen::Vector3d(-1, -1, 1), nodes, node));
  ASSERT_TRUE(std::dynamic_pointer_cast<SolverBoxFDDP>(solver.get_inner()));
  EXPECT_TRUE(solver.solve({}, {}, 300)) << to_string(solver.reason());
  EXPECT_NEAR(solver.get_xs()[10][0], -0.6, 1e-8);
  EXPECT_GE(solver.get_xs()[10][1], -0.45 - 1e-8);
  EXPECT_LT(residual_of(solver, true), 1e-6);
  int at_limit = 0;
  for (const Eigen::VectorXd& u : solver.get_us()) {
    EXPECT_TRUE((u.array() >= node->get_u_lb().array()).all() && (u.array() <= node->get_u_ub().array()).all());
    at_limit += std::abs(u[0]) == 1 || std::abs(u[1]) == 1.5;
  }
  EXPECT_GT(at_limit, 0);
}

// ---- separate parts -------------------------------------------------------------------------------------------------

// Two unicycles never meet. Each has gates, off its optimal way.
struct TwoGated {
  std::shared_ptr<ShootingProblem> problem;
  double y10, other_y10, other_x14;  // places of the gates, of the first and of the other
};

TwoGated two_gated(MatrixStorage storage, double limit = kInfinity) {
  const auto node = [=](std::shared_ptr<ActionModelUnicycle> first, std::shared_ptr<ActionModelUnicycle> second) {
    std::vector<ActionPart> parts{{std::move(first), {0, 2, 4}, {0, 2, 4}, {0, 2}},
                                  {std::move(second), {1, 3, 5}, {1, 3, 5}, {1, 3}}};
    for (ActionPart& part : parts) {
      part.model->set_u_lb(Eigen::Vector2d::Constant(-limit));
      part.model->set_u_ub(Eigen::Vector2d::Constant(limit));
    }
    auto out = std::make_shared<ActionModelParts>(std::make_shared<StateVector>(6), 4, std::move(parts));
    out->set_storage(storage);
    return out;
  };
  const auto plain = [] { return std::make_shared<ActionModelUnicycle>(); };
  std::vector<NodePtr> nodes(20, node(plain(), plain()));
  const Eigen::VectorXd x0 = (Eigen::VectorXd(6) << -1, 1, -1, 1, 1, 0.5).finished();
  SolverSparse free(std::make_shared<ShootingProblem>(x0, nodes, nodes[0]), limit < kInfinity);
  EXPECT_TRUE(free.solve());
  const Vectors& xs = free.get_xs();
  TwoGated out{nullptr, xs[10][2] - 0.1, xs[10][3] + 0.1, xs[14][1] + 0.02};
  nodes[10] = node(std::make_shared<Gate>(-kInfinity, out.y10), std::make_shared<Gate>(out.other_y10, 2));
  nodes[14] = node(std::make_shared<Gate>(-2, 2), std::make_shared<Gate>(-2, 2, out.other_x14));
  out.problem = std::make_shared<ShootingProblem>(x0, nodes, node(plain(), std::make_shared<Gate>(-2, 2)));
  out.problem->set_nthreads(1);
  return out;
}

TEST(AugmentedLagrangian, OfSeparatePartsTakesTheStepsOfTheWhole) {
  for (const double limit : {kInfinity, 1.5}) {
    SCOPED_TRACE(limit);
    const TwoGated gates = two_gated(MatrixStorage::kSparse, limit);
    SolverAugmentedLagrangian dense(two_gated(MatrixStorage::kDense, limit).problem), sparse(gates.problem);
    EXPECT_EQ(dynamic_cast<SolverSparse*>(dense.get_inner().get()), nullptr);
    ASSERT_NE(dynamic_cast<SolverSparse*>(sparse.get_inner().get()), nullptr);
    EXPECT_EQ(sparse.get_inner()->keeps_limits(), limit < kInfinity);
    const auto dense_log = std::make_shared<CallbackLogger>(), sparse_log = std::make_shared<CallbackLogger>();
    dense.setCallbacks({dense_log});
    sparse.setCallbacks({sparse_log});
    EXPECT_TRUE(dense.solve({}, {}, 300)) << to_string(dense.reason());
    EXPECT_TRUE(sparse.solve({}, {}, 300)) << to_string(sparse.reason());
    EXPECT_GT(sparse.get_outer_iter(), 2u);
    EXPECT_EQ(sparse.get_outer_iter(), dense.get_outer_iter());
    ASSERT_EQ(sparse_log->costs.size(), dense_log->costs.size());
    // (Lengths of quasi-Newton steps are interpolated between costs that finally differ by rounding alone.)
    for (std::size_t k = 0; k < dense_log->costs.size(); ++k)
      EXPECT_LT(std::abs(sparse_log->costs[k] - dense_log->costs[k]), 1e-9 * dense_log->costs[k]) << k;
    EXPECT_LT(difference_of(stacked(sparse), stacked(dense)), 1e-7);
    const Vectors& xs = sparse.get_xs();
    EXPECT_NEAR(xs[10][2], gates.y10, 1e-8);
    EXPECT_NEAR(xs[10][3], gates.other_y10, 1e-8);
    EXPECT_NEAR(xs[14][1], gates.other_x14, 1e-8);
    EXPECT_LT(residual_of(sparse, limit < kInfinity), 1e-6);
    // a node has g of both parts, then h
    const Vectors y = sparse.get_multipliers();
    ASSERT_EQ(y[10].size(), 2);
    ASSERT_EQ(y[14].size(), 3);
    EXPECT_EQ(y[20].size(), 1);
    EXPECT_EQ(y[0].size(), 0);
    EXPECT_GT(y[10][0], 1e-3);
    EXPECT_LT(y[10][1], -1e-3);
    EXPECT_EQ(y[14][0], 0);
    EXPECT_GT(std::abs(y[14][2]), 1e-3);
    for (std::size_t t = 0; t < y.size(); ++t)
      for (Eigen::Index i = 0; i < y[t].size(); ++i)
        EXPECT_NEAR(y[t][i], dense.get_multipliers()[t][i], 1e-5 * (1 + std::abs(y[t][i]))) << t << " " << i;
  }
}

TEST(AugmentedLagrangian, OfSeparatePartsStartsFromItsLastMultipliers) {
  const TwoGated gates = two_gated(MatrixStorage::kSparse);
  SolverAugmentedLagrangian solver(gates.problem);
  ASSERT_TRUE(solver.solve({}, {}, 300));
  const Vectors xs = solver.get_xs(), us = solver.get_us(), y = solver.get_multipliers();
  solver.reset();
  EXPECT_EQ(solver.get_multipliers()[10], Eigen::VectorXd::Zero(2));
  solver.set_multipliers(y);
  EXPECT_EQ(solver.get_multipliers()[10], y[10]);
  EXPECT_TRUE(solver.solve(xs, us, 100, true));
  EXPECT_LE(solver.get_outer_iter(), 2u);
  solver.circularAppend(gates.problem->get_runningModels()[0]);
  EXPECT_EQ(solver.get_multipliers()[9].size(), 2);
  EXPECT_EQ(solver.get_multipliers()[19].size(), 0);
  gates.problem->set_x0(xs[1]);
  solver.solve(xs, us, 30);
  EXPECT_LE(solver.get_xs()[9][2], gates.y10 + 0.01);
  EXPECT_NEAR(solver.get_xs()[13][1], gates.other_x14, 0.01);
}

// Parts that never meet have the solutions that each has alone.
TEST(AugmentedLagrangian, OfSeparatePartsIsThatOfEach) {
  const TwoGated gates = two_gated(MatrixStorage::kSparse);
  SolverAugmentedLagrangian both(gates.problem);
  ASSERT_TRUE(both.solve({}, {}, 300));
  double cost = 0;
  for (const ShootingPart& part : separate(*gates.problem)) {
    SolverAugmentedLagrangian own(part.problem);
    ASSERT_TRUE(own.solve({}, {}, 300)) << to_string(own.reason());
    cost += own.get_cost();
    for (std::size_t t = 0; t < own.get_xs().size(); ++t) {
      Eigen::VectorXd x;
      gather(both.get_xs()[t], part.x, x);
      EXPECT_LT((x - own.get_xs()[t]).lpNorm<Eigen::Infinity>(), 1e-6) << t;
    }
  }
  EXPECT_NEAR(both.get_cost(), cost, 1e-7 * cost);
}

// ---- warm starts ----------------------------------------------------------------------------------------------------

TEST(AugmentedLagrangian, StartsFromItsLastMultipliers) {
  const auto problem = gated(std::make_shared<Gate>(-kInfinity, -0.12));
  SolverAugmentedLagrangian solver(problem);
  EXPECT_TRUE(solver.solve({}, {}, 200));
  const std::size_t first = solver.get_outer_iter();
  const Vectors xs = solver.get_xs(), us = solver.get_us(), multipliers = solver.get_multipliers();
  EXPECT_GT(first, 2u);
  EXPECT_TRUE(solver.solve(xs, us, 100, true));
  EXPECT_EQ(solver.get_outer_iter(), 1u);
  solver.reset();
  EXPECT_EQ(solver.get_multipliers()[10][0], 0);
  EXPECT_EQ(solver.get_penalty(), solver.get_penalty_init());
  solver.set_multipliers(multipliers);
  EXPECT_TRUE(solver.solve(xs, us, 100, true));
  EXPECT_LE(solver.get_outer_iter(), 2u);
  // one shift of the horizon later
  solver.circularAppend(std::make_shared<ActionModelUnicycle>());
  EXPECT_EQ(solver.get_multipliers()[9].size(), 1);
  EXPECT_NEAR(solver.get_multipliers()[9][0], multipliers[10][0], 1e-5);
  EXPECT_EQ(solver.get_multipliers()[10].size(), 0);
  problem->set_x0(xs[1]);
  EXPECT_TRUE(solver.solve(xs, us, 200)) << to_string(solver.reason());
  EXPECT_LE(solver.get_xs()[9][1], -0.12 + 1e-8);
}

// A node that counts its evaluations and its data.
class Counted : public Gate {
 public:
  using Gate::Gate;
  void calc(const NodeDataPtr& data, const ConstVectorRef& x, const ConstVectorRef& u) override {
    ++evaluated;
    Gate::calc(data, x, u);
  }
  using Gate::calc;
  NodeDataPtr createData() override {
    ++created;
    return Gate::createData();
  }
  int evaluated = 0, created = 0;
};

// At the solution nodes are evaluated once to start from, once in the minimisation's first iteration and once in each
// of its steps. A candidate that was evaluated last needs no further evaluation to be judged.
TEST(AugmentedLagrangian, EvaluatesNodesAsOftenAsNeeded) {
  const auto node = std::make_shared<Counted>(-kInfinity, -0.12);
  const auto problem = gated(node);
  problem->set_nthreads(1);
  SolverAugmentedLagrangian solver(problem);
  EXPECT_TRUE(solver.solve({}, {}, 200));
  const Vectors xs = solver.get_xs(), us = solver.get_us();
  node->evaluated = 0;
  EXPECT_TRUE(solver.solve(xs, us, 100, true));
  EXPECT_EQ(solver.get_outer_iter(), 1u);
  EXPECT_EQ(solver.get_iter(), 0u);
  EXPECT_EQ(node->evaluated, 4);
}

TEST(AugmentedLagrangian, AShiftOfTheHorizonTouchesOneNode) {
  const auto node = std::make_shared<Counted>(-kInfinity, -0.12);
  const auto problem =
      std::make_shared<ShootingProblem>(Eigen::Vector3d(-1, -1, 1), std::vector<NodePtr>(20, node), node);
  SolverAugmentedLagrangian solver(problem);
  solver.solve({}, {}, 3);
  const ShootingProblem::Models before = solver.get_inner()->get_problem()->get_runningModels();
  node->created = 0;
  solver.circularAppend(node);
  EXPECT_EQ(node->created, 1);
  const ShootingProblem::Models after = solver.get_inner()->get_problem()->get_runningModels();
  EXPECT_TRUE(std::equal(before.begin() + 1, before.end(), after.begin()));
  solver.circularAppend(node, problem->get_runningDatas()[0]);
  EXPECT_EQ(node->created, 1);
  EXPECT_TRUE(solver.solve({}, {}, 300)) << to_string(solver.reason());
}

// ---- an arm ---------------------------------------------------------------------------------------------------------

// At the end the tool rests at a point; until the last five nodes it is 0.1 m above that point, on a table.
struct ReachingArm {
  SceneFile file = load_text(
      "<scene><robot name=\"arm\" urdf=\"arm.urdf\" base=\"fixed\"><q>0.1 0.9 0.2 1.2 0.1 -0.5 "
      "0.3</q></robot></scene>");
  std::shared_ptr<StateMultibody> state = std::make_shared<StateMultibody>(file.scene);
  std::shared_ptr<ActuationModelAbstract> actuation = std::make_shared<ActuationModelFull>(state);
  std::size_t nu = actuation->get_nu();
  Eigen::VectorXd x0 = (Eigen::VectorXd(14) << file.q, file.v).finished();
  std::shared_ptr<ResidualModelAbstract> tool = std::make_shared<ResidualModelFrameTranslation>(
      state, state->get_model()->getFrameId("tool"), Eigen::Vector3d::Zero(), nu);
  Eigen::Vector3d goal = place(x0) + Eigen::Vector3d(-0.1, 0.3, -0.25);

  NodePtr node(const Eigen::Vector3d& lower, const Eigen::Vector3d& upper, double step, bool constrained = true) const {
    auto costs = std::make_shared<CostModelSum>(state, nu);
    costs->addCost(
        "state", std::make_shared<CostModelResidual>(state, std::make_shared<ResidualModelState>(state, x0, nu)), 0.1);
    if (step > 0)
      costs->addCost("control",
                     std::make_shared<CostModelResidual>(state, std::make_shared<ResidualModelControl>(state, nu)),
                     1e-3);
    auto constraints = std::make_shared<ConstraintModelManager>(state, nu);
    if (constrained)
      constraints->addConstraint("tool", std::make_shared<ConstraintModelResidual>(state, tool, lower, upper));
    return std::make_shared<IntegratedActionModelEuler>(
        std::make_shared<DifferentialActionModelFreeFwdDynamics>(state, actuation, costs, constraints), step);
  }
  Eigen::Vector3d place(const Eigen::VectorXd& x) const {
    const auto model = std::dynamic_pointer_cast<IntegratedActionModelEuler>(
        node(Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero(), 0));
    const NodeDataPtr data = model->createData();
    model->calc(data, x);
    return data->h;
  }
  std::shared_ptr<ShootingProblem> problem(bool table, const Eigen::Vector3d& at) const {
    const Eigen::Vector3d open = Eigen::Vector3d::Constant(kInfinity);
    Eigen::Vector3d above = -open;
    above[2] = at[2] + 0.1;
    std::vector<NodePtr> nodes(30, node(above, open, 0.02, table));
    std::fill(nodes.end() - 5, nodes.end(), node(above, open, 0.02, false));
    return std::make_shared<ShootingProblem>(x0, nodes, node(at, at, 0));
  }
};

TEST(AugmentedLagrangian, AnArmReachesExactlyOverATable) {
  const ReachingArm arm;
  for (const bool table : {false, true}) {
    const auto problem = arm.problem(table, arm.goal);
    const Guess guess = standing(*problem);
    SolverAugmentedLagrangian solver(problem);
    EXPECT_TRUE(solver.solve(guess.xs, guess.us, 300)) << to_string(solver.reason());
    EXPECT_LE((arm.place(solver.get_xs().back()) - arm.goal).lpNorm<Eigen::Infinity>(), 1e-8);
    EXPECT_LT(residual_of(solver), 1e-6);
    double lowest = kInfinity;
    int bound = 0;
    for (std::size_t t = 0; t < 25; ++t) {
      const double height = arm.place(solver.get_xs()[t])[2] - (arm.goal[2] + 0.1);
      lowest = std::min(lowest, height);
      if (!table) continue;
      const double y = solver.get_multipliers()[t][2];
      bound += y < -1e-3;
      EXPECT_LE(y, 0) << t;
      EXPECT_LE(std::abs(y * std::max(height, 0.0)), 1e-6) << t;  // complementarity
    }
    if (table) {
      EXPECT_GE(lowest, -1e-8);
      EXPECT_GT(bound, 0);
    } else {
      EXPECT_LT(lowest, -1e-3);
    }
  }
}

TEST(AugmentedLagrangian, TakesNoMemoryInItsIterations) {
  if (!MANYCONTACT_COUNTS_ALLOCATIONS) GTEST_SKIP() << "malloc cannot be counted here";
  const ReachingArm arm;
  const auto problem = arm.problem(true, arm.goal);
  problem->set_nthreads(1);
  const Guess guess = standing(*problem);
  SolverAugmentedLagrangian solver(problem);
  solver.solve(guess.xs, guess.us, 40);
  EXPECT_GT(solver.get_outer_iter(), 1u);
  EXPECT_EQ(allocations([&] { solver.solve(guess.xs, guess.us, 40); }), 0u);
}

TEST(AugmentedLagrangian, GivesTheSameBitsForAnyNumberOfThreads) {
  const ReachingArm arm;
  std::vector<Eigen::VectorXd> answers;
  for (const int threads : {1, 2, 3}) {
    const auto problem = arm.problem(true, arm.goal);
    problem->set_nthreads(threads);
    const Guess guess = standing(*problem);
    SolverAugmentedLagrangian solver(problem);
    solver.solve(guess.xs, guess.us, 12);
    answers.push_back(stacked(solver));
  }
  EXPECT_TRUE(answers[1] == answers[0]);
  EXPECT_TRUE(answers[2] == answers[0]);
}

// ---- failure --------------------------------------------------------------------------------------------------------

TEST(AugmentedLagrangian, SaysThatConstraintsCannotBeMet) {
  const ReachingArm arm;
  const auto far = arm.problem(false, Eigen::Vector3d(2, 0, 1));  // the arm is 1.12 m long
  const Guess guess = standing(*far);
  SolverAugmentedLagrangian arms(far);
  EXPECT_FALSE(arms.solve(guess.xs, guess.us, 1000));
  // (Near a stretched arm linear steps promise to remove all of it: quasi-Newton steps come to rest there.)
  EXPECT_EQ(arms.reason(), StopReason::kInfeasible) << to_string(arms.reason());
  EXPECT_GT(arms.get_violation(), 0.5);
  // x0 violates the constraint
  const auto node = std::make_shared<ActionModelUnicycle>();
  std::vector<NodePtr> nodes(10, node);
  nodes[0] = std::make_shared<Gate>(0, 1);
  SolverAugmentedLagrangian first(std::make_shared<ShootingProblem>(Eigen::Vector3d(-1, -1, 1), nodes, node));
  EXPECT_FALSE(first.solve({}, {}, 1000));
  EXPECT_EQ(first.reason(), StopReason::kInfeasible) << to_string(first.reason());
  EXPECT_EQ(first.get_violation(), 1);
  for (const SolverAbstract* solver : std::initializer_list<const SolverAbstract*>{&arms, &first})
    EXPECT_TRUE(stacked(*solver).allFinite());
}

TEST(AugmentedLagrangian, SaysWhyItStopped) {
  const auto problem = gated(std::make_shared<Gate>(-kInfinity, -0.12));
  SolverAugmentedLagrangian solver(problem);
  EXPECT_EQ(solver.reason(), StopReason::kNone);
  EXPECT_FALSE(solver.solve({}, {}, 3));
  EXPECT_EQ(solver.reason(), StopReason::kIterations);
  EXPECT_FALSE(solver.solve({}, {}, 0));
  EXPECT_EQ(solver.reason(), StopReason::kIterations);
  struct Interrupts : CallbackAbstract {
    std::size_t count = 0;
    void operator()(SolverAbstract& s) override {
      if (++count == 2) s.interrupt();
    }
  };
  const auto callback = std::make_shared<Interrupts>();
  solver.setCallbacks({callback});
  EXPECT_FALSE(solver.solve());
  EXPECT_EQ(solver.reason(), StopReason::kInterrupted);
  EXPECT_EQ(callback->count, 2u);
  EXPECT_EQ(solver.get_iter(), 1u);

  // constraints are not finite anywhere but at the guess
  struct Hole : Gate {
    Hole() : Gate(-kInfinity, 1) {}
    void calc(const NodeDataPtr& data, const ConstVectorRef& x, const ConstVectorRef& u) override {
      Gate::calc(data, x, u);
      if (!u.isZero(0)) data->g[0] = NAN;
    }
    using Gate::calc;
  };
  SolverAugmentedLagrangian hole(gated(std::make_shared<Hole>()));
  EXPECT_FALSE(hole.solve());
  EXPECT_EQ(hole.reason(), StopReason::kNoStep) << to_string(hole.reason());
  EXPECT_TRUE(stacked(hole).allFinite());
  SolverAugmentedLagrangian nan(gated(std::make_shared<Gate>(-kInfinity, 1, 1e300)));
  EXPECT_FALSE(nan.solve());
  EXPECT_TRUE(nan.reason() != StopReason::kNone && nan.reason() != StopReason::kConverged);
}

TEST(AugmentedLagrangian, RefusesMisuse) {
  EXPECT_THROW(SolverAugmentedLagrangian(nullptr), std::invalid_argument);
  const auto problem = gated(std::make_shared<Gate>(-kInfinity, -0.12));
  const auto wrong = [&](auto) { return std::make_shared<SolverFDDP>(problem); };
  EXPECT_THROW(SolverAugmentedLagrangian(problem, wrong), std::invalid_argument);
  SolverAugmentedLagrangian solver(problem);
  EXPECT_THROW(solver.set_penalty(0), std::invalid_argument);
  EXPECT_THROW(solver.set_penalty_factor(1), std::invalid_argument);
  EXPECT_THROW(solver.set_th_constraint(0), std::invalid_argument);
  EXPECT_THROW(solver.set_th_kkt(-1), std::invalid_argument);
  EXPECT_THROW(solver.set_multipliers({}), std::invalid_argument);
  EXPECT_THROW(solver.set_multipliers(Vectors(21)), std::invalid_argument);
  EXPECT_THROW(kkt_residual(*problem, solver.get_xs(), solver.get_us(), {}, false), std::invalid_argument);
}

}  // namespace
}  // namespace manycontact::test
