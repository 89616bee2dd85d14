// Many bodies have redundant contacts. The dense reference solver is used only on request; the solutions agree with it.

#include "support/piles.hpp"

#include <gtest/gtest.h>

#include "manycontact/dynamics/differentiate.hpp"
#include "manycontact/dynamics/jvp.hpp"
#include "manycontact/dynamics/shapes.hpp"
#include "manycontact/dynamics/solve.hpp"
#include "support/allocations.hpp"

namespace manycontact::test {
namespace {

using Eigen::VectorXd;

double relative(const VectorXd& x, const VectorXd& truth, double least = 0) {
  return (x - truth).cwiseAbs().maxCoeff() / std::max(truth.cwiseAbs().maxCoeff(), least);
}

struct Case {
  std::string name;
  Pile pile;
};
// Each case has more than 300 rows of J. In motion contacts of loops are inconsistent.
Case case_of(int number, double speed = 0.1) {
  switch (number) {
    case 0:
      return {"tower", tower(60, speed)};
    case 1:
      return {"pyramid", pyramid(8, speed)};
    case 2:
      return {"wall", grid(8, ContactType::k3D, true, speed)};
    case 3:
      return {"grid", grid(6, ContactType::k6D, false, speed)};
    case 4:
      return {"hub", hub(7, speed)};
    case 5:
      return {"uneven", uneven_wall(8, speed)};
    default:
      return {"table", table(60, speed)};
  }
}
constexpr int kCases = 7;
std::string name_of(const testing::TestParamInfo<int>& info) { return case_of(info.param).name; }

class Piles : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Of, Piles, testing::Range(0, kCases), name_of);

TEST_P(Piles, AreSolvedSparselyWithTheOraclesAnswers) {
  const Pile pile = case_of(GetParam()).pile;
  SceneData data(pile.scene), oracle(pile.scene, {Method::kDense, {}});
  (void)solve(pile.scene, pile.q, pile.v, pile.u, data);
  (void)solve(pile.scene, pile.q, pile.v, pile.u, oracle);
  ASSERT_GT(data.report.nc, 300);
  EXPECT_NE(data.report.islands[0].method, Method::kDense);
  EXPECT_EQ(data.report.status, oracle.report.status);
  EXPECT_EQ(data.report.rank, oracle.report.rank);
  EXPECT_EQ(data.report.islands[0].dependent_rows.size(), oracle.report.islands[0].dependent_rows.size());
  EXPECT_LE(relative(data.a, oracle.a), 1e-10);
  EXPECT_LE(relative(data.f, oracle.f), 1e-10);
}

// On these random piles a test of the pivots' sizes alone gives a wrong rank or solution, or refuses: a row may nearly
// depend on those before it. Where the configuration is nearly singular (14, 25), the dense solver is used.
constexpr unsigned kRandomPiles[] = {1, 7, 12, 14, 25, 36, 64, 85, 112, 118};
TEST(RandomPiles, HaveTheDenseSolversAnswers) {
  for (const unsigned seed : kRandomPiles) {
    SCOPED_TRACE(seed);
    const Pile pile = random_pile(seed);
    SceneData data(pile.scene), dense(pile.scene, {Method::kDense, {}});
    (void)solve(pile.scene, pile.q, pile.v, pile.u, data);
    (void)solve(pile.scene, pile.q, pile.v, pile.u, dense);
    EXPECT_EQ(data.report.status, dense.report.status);
    EXPECT_EQ(data.report.rank, dense.report.rank);
    EXPECT_LE(relative(data.a, dense.a, 9.81), 1e-9);
    EXPECT_LE(relative(data.f, dense.f), 1e-8);
  }
}

// 256 boxes are on a hub and on each other. With contacts last, the rows of all of them fill one dense matrix; the
// contacts of boxes that others fix already go early.
TEST(PilesOnAHub, AreSolvedInAnOrderThatStaysSparse) {
  const Pile pile = hub(16, 0);
  SceneData data(pile.scene);
  const Report& report = solve(pile.scene, pile.q, pile.v, pile.u, data);
  EXPECT_EQ(report.status, Status::kRedundant);
  EXPECT_EQ(report.rank, pile.scene.nv);
  EXPECT_EQ(report.islands[0].order, Order::kContactsEarly);
  EXPECT_LT(report.factor_nonzeros, 1000000);  // with contacts last 4.4 million
  EXPECT_LE(data.a.cwiseAbs().maxCoeff(), 1e-10);
  EXPECT_NEAR(contact_force(pile.scene, data, 0)[2] / (257 * 9 * 9.81), 1, 1e-10);
}

// At rest the accelerations vanish, and all terms of the rows between boxes are rounding error. Compared with each
// other they would refuse the solution box by box, and the whole K would be factorized.
TEST(PilesAtRest, AreSolvedBoxByBox) {
  for (const double damping : {0.0, 1e-8}) {
    Pile pile = tower(60, 0);
    pile.scene.damping = damping;
    SceneData data(pile.scene);
    const Report& report = solve(pile.scene, pile.q, pile.v, pile.u, data);
    EXPECT_EQ(report.status, Status::kOk);
    EXPECT_EQ(factorizations_of(data, 0), 1);
    EXPECT_LE(report.backward_error, 1e-12);
    const double top = damping * 9 * 9.81 * 60 * 61 / 2;  // each contact yields to the weight above it
    EXPECT_NEAR(data.a.cwiseAbs().maxCoeff(), top, 1e-10 + top * top / 9.81);  // weights are less by that part
  }
}

TEST_P(Piles, HaveTheOraclesProducts) {
  const Pile pile = case_of(GetParam(), 0).pile;
  SceneData data(pile.scene), oracle(pile.scene, {Method::kDense, {}});
  (void)solve(pile.scene, pile.q, pile.v, pile.u, data);
  (void)solve(pile.scene, pile.q, pile.v, pile.u, oracle);
  EXPECT_EQ(data.report.status, oracle.report.status);
  EXPECT_LE(relative(data.a, oracle.a, 9.81), 1e-10);
  EXPECT_LE(relative(data.f, oracle.f), 1e-10);
  std::mt19937 rng(5);
  const VectorXd dq = random_vector(pile.scene.nv, rng), dv = random_vector(pile.scene.nv, rng),
                 du = random_vector(pile.scene.nu, rng), wf = random_vector(static_cast<int>(data.f.size()), rng);
  const auto products = [&](SceneData& of) {
    VectorXd da(pile.scene.nv), df(of.f.size()), wq(pile.scene.nv), wv(pile.scene.nv), wu(pile.scene.nu), all;
    jvp(pile.scene, of, dq, dv, du, da, df);
    vjp(pile.scene, of, dq, wf, wq, wv, wu);
    return std::array{da, df, wq, wv};
  };
  const auto x = products(data), y = products(oracle);
  for (std::size_t k = 0; k < x.size(); ++k) EXPECT_LE(relative(x[k], y[k], 1), 1e-9) << k;
}

// Derivatives agree with products, which agree with the dense reference solver.
TEST_P(Piles, HaveTheDerivativesOfTheirProducts) {
  const Pile pile = case_of(GetParam(), 0).pile;
  SceneData data(pile.scene);
  (void)solve(pile.scene, pile.q, pile.v, pile.u, data);
  std::mt19937 rng(6);
  const VectorXd dq = random_vector(pile.scene.nv, rng), dv = random_vector(pile.scene.nv, rng),
                 du = random_vector(pile.scene.nu, rng);
  VectorXd da(pile.scene.nv), df(data.f.size());
  jvp(pile.scene, data, dq, dv, du, da, df);
  differentiate(pile.scene, data);
  EXPECT_NE(data.report.islands[0].method, Method::kDense);
  const SceneDerivatives x = dense_derivatives(pile.scene, data);
  EXPECT_LE(relative(x.da_dq * dq + x.da_dv * dv, da, 1), 1e-9);
  EXPECT_LE(relative(x.dforces_dq * dq + x.dforces_dv * dv, df), 1e-9);
}

TEST_P(Piles, AllocateNothingAgain) {
  if (!MANYCONTACT_COUNTS_ALLOCATIONS) GTEST_SKIP() << "malloc cannot be counted here";
  const Pile pile = case_of(GetParam()).pile;
  SceneData data(pile.scene);
  const auto solve_once = [&] { (void)solve(pile.scene, pile.q, pile.v, pile.u, data); };
  solve_once();
  EXPECT_EQ(allocations(solve_once), 0u);
}

TEST_P(Piles, AnswersDependOnTheStateAlone) {
  const Pile pile = case_of(GetParam()).pile;
  SceneData data(pile.scene);
  (void)solve(pile.scene, pile.q, pile.v, pile.u, data);
  const VectorXd a = data.a, f = data.f;
  (void)solve(pile.scene, pile.q, (2 * pile.v).eval(), pile.u, data);
  (void)solve(pile.scene, pile.q, pile.v, pile.u, data);
  EXPECT_TRUE(a == data.a);
  EXPECT_TRUE(f == data.f);
}

}  // namespace
}  // namespace manycontact::test
