// Every direction solver is tested on random problems: by its KKT error, and against the dense reference solvers.

#include <gtest/gtest.h>

#include <memory>

#include "manycontact/lq/coupling_schur.hpp"
#include "manycontact/lq/kkt.hpp"
#include "random_problem.hpp"
#include "support/allocations.hpp"
#include "support/dense.hpp"

namespace manycontact::test {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using lq::Status;
using Lists = std::vector<std::vector<int>>;

constexpr double kEps = 2.3e-16;

struct Case {
  std::string name;
  LqOptions options;
  lq::Regularisation reg;
  bool riccati = true;  // false: stagewise elimination is impossible
};

void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }

std::function<Lists(int)> always(Lists lists) {
  return [=](int) { return lists; };
}

// Returns the lists in running knots.
std::function<Lists(int)> running(const LqOptions& options, Lists lists) {
  return [=, T = options.horizon](int k) { return k < T ? lists : Lists{}; };
}

std::vector<Case> cases() {
  std::vector<Case> all;
  const auto add = [&](const char* name) -> LqOptions& {
    all.push_back({name, {}, {}, true});
    return all.back().options;
  };
  add("Separate");
  add("OneBlock").nx = {5};
  all.back().options.nu = {2};
  add("OneKnot").horizon = 0;
  add("JoinedThroughout").groups = always({{2, 0}, {1, 3}});
  add("JoinedLater").groups = [](int k) { return k > 8 ? Lists{{3, 1}} : Lists{}; };
  add("JoinedEarlier").groups = [](int k) { return k < 4 ? Lists{{3, 1}} : Lists{}; };
  add("Changing").groups = [](int k) {
    return k < 4 ? Lists{{2, 0}} : k < 7 ? Lists{{0, 1}} : k < 9 ? Lists{{3, 2}} : Lists{{0}, {1, 3}};
  };
  add("MergedInTwoOrders").groups = [](int k) { return k % 2 ? Lists{{0, 1, 2}, {3}} : Lists{{2}, {1}, {0}, {3}}; };
  add("NoCostOnStates").state_weight = 0;
  add("Unstable").growth = 1.3;
  add("TimesTwo").growth = 2;

  LqOptions* o = &add("Chain");
  o->couplings = running(*o, {{0, 1}, {1, 2}, {2, 3}});
  o = &add("Ring");
  o->couplings = running(*o, {{0, 1}, {1, 2}, {2, 3}, {3, 0}});
  o = &add("Star");
  o->couplings = running(*o, {{0, 1}, {0, 2}, {0, 3}});
  o = &add("ThreeInABond");
  o->couplings = running(*o, {{0, 1, 3}});
  o = &add("TwoCouplingsOfOnePair");
  o->couplings = running(*o, {{2, 1}, {1, 2}});
  o = &add("CouplingsComeAndGo");
  o->couplings = [](int k) {
    return k < 3 ? Lists{{0, 1}} : k < 6 ? Lists{{1, 2}, {0, 1}} : k < 9 ? Lists{} : Lists{{2, 3}};
  };
  o = &add("CouplingsOfGroups");
  o->groups = [](int k) { return k < 5 ? Lists{{2, 0}} : Lists{{0}, {2}}; };
  o->couplings = running(*o, {{0, 1}, {2, 3}});
  o = &add("CouplingWithinAGroup");
  o->groups = always({{2, 0}});
  o->couplings = running(*o, {{0, 2}, {2, 3}});
  o = &add("ForceAndAcceleration");
  o->coupling_size = 4;
  o->coupling_weight = 0.5;
  o->couplings = running(*o, {{0, 1}, {2, 1}});
  o = &add("CouplingsThatCost");
  o->coupling_weight = 1;
  o->couplings = running(*o, {{0, 1}, {1, 2}});
  o = &add("ObjectWithoutControls");
  o->nu = {3, 0, 3, 0};
  o->couplings = running(*o, {{0, 1}, {2, 1}});
  o = &add("CouplingOfTwoObjects");
  o->nu = {3, 0, 0, 3};
  o->couplings = running(*o, {{0, 1}, {1, 2}, {2, 3}});
  o = &add("EqualityConstraints");
  o->coupling_size = 0;
  o->coupling_rows = 1;
  o->couplings = running(*o, {{0}, {1}, {2}});
  o = &add("EqualityConstraintsOfLaterKnots");
  o->nx = {4, 3, 5};
  o->nu = {1, 1, 2};
  o->coupling_size = 0;
  o->coupling_rows = 1;
  o->couplings = [T = o->horizon](int k) { return k == T ? Lists{{0}, {1, 2}} : Lists{}; };
  all.back().riccati = false;
  o = &add("NoCostOnStatesWithCouplings");
  o->state_weight = 0;
  o->couplings = running(*o, {{0, 1}, {1, 2}, {2, 3}});
  o = &add("UnstableWithCouplings");
  o->growth = 1.3;
  o->couplings = running(*o, {{0, 1}, {1, 2}, {2, 3}});

  for (const int part : {1, 2, 3, 6}) {
    static const std::string names[] = {"StepsOfOne", "StepsOfTwo", "StepsOfThree", "StepsOfSix"};
    o = &add(names[part == 6 ? 3 : part - 1].c_str());
    o->steps = part;
    o->nx = {4, 6, 14, 8};
    o->couplings = running(*o, {{0, 1}, {1, 2}, {2, 3}});
  }
  o = &add("StepsOfSomeBlocks");
  o->steps = 2;
  o->nx = {4, 3, 6, 2};
  o->couplings = running(*o, {{0, 1}, {1, 2}, {2, 3}});
  o = &add("StepsOfSomeKnots");
  o->steps = 2;
  o->nx = {4, 6, 6, 4};
  o->groups = [](int k) { return k > 8 ? Lists{{3, 1}} : Lists{}; };
  o->couplings = running(*o, {{0, 1}, {1, 2}, {2, 3}});
  o = &add("StepsWithCouplingsOfOne");
  o->steps = 2;
  o->nx = {4, 6, 2, 8};
  o->coupling_size = 0;
  o->coupling_rows = 1;
  o->couplings = running(*o, {{0}, {1}, {1, 2}});
  add("StepsOfSeparateBlocks").steps = 1;
  all.back().options.nx = {4, 6, 2, 8};

  add("RegularisedControls").control_weight = 0;
  all.back().options.state_weight = 0;
  all.back().reg = {0, 1e-3, 0};
  add("RegularisedStates").groups = always({{0, 3}});
  all.back().reg = {1e-2, 1e-4, 0};
  o = &add("ProximalCouplings");
  o->couplings = running(*o, {{0, 1}, {1, 2}, {0, 1}});
  all.back().reg = {1e-3, 1e-3, 1e-2};
  return all;
}

struct Solvers {
  lq::Riccati dense{lq::Join::kAll}, islands{lq::Join::kIslands};
  lq::CouplingSchur schur;
  std::vector<lq::DirectionSolver*> of(const Case& c) {
    if (!c.riccati) return {&schur};
    return {&dense, &islands, &schur};
  }
};

double relative(const VectorXd& a, const VectorXd& truth) {
  return (a - truth).cwiseAbs().maxCoeff() / truth.cwiseAbs().maxCoeff();
}

class DirectionSolvers : public testing::TestWithParam<Case> {
 protected:
  const Case& c = GetParam();
  std::mt19937 rng{11};
  lq::Problem problem = random_lq(rng, c.options);
  Solvers solvers;
};

// The reference for all is one dense matrix of the optimality conditions. Errors of 100 eps cond are allowed.
TEST_P(DirectionSolvers, EqualTheDenseKktMatrix) {
  VectorXd h;
  const MatrixXd H = dense_kkt(problem, c.reg, h);
  EXPECT_LE((H - H.transpose()).cwiseAbs().maxCoeff(), 1e-13 * H.cwiseAbs().maxCoeff());
  const VectorXd truth = solved(H, -h), sizes = eigenvalues(H).cwiseAbs();
  const double cond = sizes.maxCoeff() / sizes.minCoeff();
  const double allowed = std::max(1e-12, 100 * kEps * cond);
  ASSERT_LT(allowed, 1e-6) << "the problem says nothing";
  for (lq::DirectionSolver* solver : solvers.of(c)) {
    solver->analyse(problem);
    lq::Outcome outcome = solver->factorize(problem, c.reg);
    ASSERT_EQ(outcome.status, Status::kOk) << solver->name() << ", knot " << outcome.knot;
    lq::Point z;
    outcome = solver->solve(problem, z);
    EXPECT_EQ(outcome.status, Status::kOk) << solver->name();
    EXPECT_LE(outcome.kkt_error, lq::kRefineAbove) << solver->name();
    EXPECT_EQ(outcome.kkt_error, lq::kkt_error(problem, z, c.reg)) << solver->name();
    EXPECT_LE(relative(flat(z), truth), allowed) << solver->name() << ", condition " << cond;
    RecordProperty(solver->name(), std::to_string(outcome.kkt_error));
  }
}

TEST_P(DirectionSolvers, EqualDenseRiccati) {
  if (!c.riccati) GTEST_SKIP();
  lq::Point truth, z;
  for (lq::DirectionSolver* solver : solvers.of(c)) {
    solver->analyse(problem);
    ASSERT_EQ(solver->factorize(problem, c.reg).status, Status::kOk);
    ASSERT_EQ(solver->solve(problem, z).status, Status::kOk);
    if (solver == &solvers.dense) truth = z;
    EXPECT_LE(relative(flat(z), flat(truth)), 1e-9) << solver->name();
  }
}

// lambda_k is V's gradient, and the policy reproduces the controls.
TEST_P(DirectionSolvers, PoliciesAndValueFunctionFitTheSolution) {
  const lq::Layout layout(problem);
  for (lq::Riccati* solver : {&solvers.dense, &solvers.islands}) {
    if (!c.riccati) continue;
    solver->analyse(problem);
    ASSERT_EQ(solver->factorize(problem, c.reg).status, Status::kOk);
    lq::Point z;
    ASSERT_EQ(solver->solve(problem, z).status, Status::kOk);
    for (int k = 0; k <= problem.horizon(); ++k)
      for (std::size_t i = 0; i < solver->plan()[k].size(); ++i) {
        const lq::Cluster& cluster = solver->plan()[k][i];
        const auto& policy = solver->policy(k, static_cast<int>(i));
        VectorXd x(cluster.nx), u(cluster.nu), lambda(cluster.nx);
        for (std::size_t b = 0; b < cluster.blocks.size(); ++b) {
          const int block = cluster.blocks[b], nx = problem.nx[block], nu = problem.nu[block];
          x.segment(cluster.x_start[b], nx) = z.x[k].segment(layout.x[block], nx);
          lambda.segment(cluster.x_start[b], nx) = z.lambda[k].segment(layout.x[block], nx);
          if (k < problem.horizon()) u.segment(cluster.u_start[b], nu) = z.u[k].segment(layout.u[block], nu);
        }
        const double size = flat(z).cwiseAbs().maxCoeff();
        EXPECT_LE((policy.P * x + policy.p - lambda).cwiseAbs().maxCoeff(), 1e-9 * size);
        EXPECT_LE(((policy.K * x + policy.k).head(cluster.nu) - u).cwiseAbs().sum(), 1e-9 * size);
        EXPECT_EQ(policy.P, policy.P.transpose());
      }
  }
}

// At the optimum of a convex problem under constraints no feasible step lowers the cost. The quadratic model of line
// searches shows it: linear + quadratic / 2 is the change of cost, and grows along any step of the null space.
TEST_P(DirectionSolvers, ChangeOfCostIsThatOfTheProblem) {
  lq::DirectionSolver* solver = solvers.of(c).front();
  const lq::Layout layout(problem);
  solver->analyse(problem);
  ASSERT_EQ(solver->factorize(problem, c.reg).status, Status::kOk);
  lq::Point z;
  ASSERT_EQ(solver->solve(problem, z).status, Status::kOk);
  const lq::Change change = lq::cost_change(problem, layout, c.reg, z);
  for (auto part : {&lq::Point::lambda, &lq::Point::mu})
    for (VectorXd& multipliers : z.*part) multipliers.setZero();
  VectorXd h;
  const MatrixXd H = dense_kkt(problem, {}, h);  // of x, u and w: q, r and Q, S, R
  const VectorXd step = flat(z);
  const double linear = h.dot(step), quadratic = step.dot(H * step);
  const double size = step.cwiseAbs().dot(h.cwiseAbs() + H.cwiseAbs() * step.cwiseAbs());
  EXPECT_NEAR(change.linear, linear, 1e-12 * size);
  EXPECT_NEAR(change.quadratic, quadratic, 1e-9 * size);
}

// Solutions are compared as the factor gives them: refinement would hide a nearly right one.
TEST_P(DirectionSolvers, StepsChangeNothing) {
  if (!c.options.steps) GTEST_SKIP();
  lq::Problem unknown = problem;
  for (lq::Knot& knot : unknown.knots)
    for (lq::Group& group : knot.groups) group.steps.reset();
  for (lq::DirectionSolver* solver : solvers.of(c)) {
    solver->max_refinements = 0;
    lq::Point z[2], later;
    for (const lq::Problem* p : {&problem, &unknown}) {
      solver->analyse(*p);
      ASSERT_EQ(solver->factorize(*p, c.reg).status, Status::kOk);
      ASSERT_EQ(solver->solve(*p, z[p == &unknown]).status, Status::kOk);
    }
    ASSERT_EQ(solver->factorize(problem, c.reg).status, Status::kOk) << "they may come after the analysis";
    ASSERT_EQ(solver->solve(problem, later).status, Status::kOk);
    EXPECT_LE(relative(flat(later), flat(z[0])), 1e-13) << solver->name();
    EXPECT_LE(relative(flat(z[0]), flat(z[1])), 1e-11) << solver->name();
    // Robots coupled to one cluster have none, and the dense recursion, the reference, uses none.
    if (solver != &solvers.islands) {
      EXPECT_EQ(flat(z[0]) == flat(z[1]), solver == &solvers.dense) << solver->name();
    }
  }
}

TEST_P(DirectionSolvers, AllocateNothingAgain) {
  if (!MANYCONTACT_COUNTS_ALLOCATIONS) GTEST_SKIP() << "malloc cannot be counted here";
  for (lq::DirectionSolver* solver : solvers.of(c)) {
    solver->analyse(problem);
    lq::Point z;
    ASSERT_EQ(solver->factorize(problem, c.reg).status, Status::kOk);
    ASSERT_EQ(solver->solve(problem, z).status, Status::kOk);
    refill(problem, rng, c.options);
    lq::Outcome outcome;
    EXPECT_EQ(allocations([&] { outcome = solver->factorize(problem, c.reg); }), 0u) << solver->name();
    ASSERT_EQ(outcome.status, Status::kOk);
    EXPECT_EQ(allocations([&] { outcome = solver->solve(problem, z); }), 0u) << solver->name();
    EXPECT_LE(lq::kkt_error(problem, z, c.reg), lq::kRefineAbove) << solver->name();
  }
}

INSTANTIATE_TEST_SUITE_P(Random, DirectionSolvers, testing::ValuesIn(cases()),
                         [](const auto& info) { return info.param.name; });

}  // namespace
}  // namespace manycontact::test
