// Problems have no solution, or one that doubles can hardly represent: a status reports it.

#include <gtest/gtest.h>

#include <memory>

#include "manycontact/lq/choose.hpp"
#include "manycontact/lq/coupling_schur.hpp"
#include "manycontact/lq/kkt.hpp"
#include "random_problem.hpp"

namespace manycontact::test {
namespace {

using lq::Status;
using Lists = std::vector<std::vector<int>>;

enum class Kind { kDense, kIslands, kCouplingSchur };

std::unique_ptr<lq::DirectionSolver> make(Kind kind) {
  if (kind == Kind::kCouplingSchur) return std::make_unique<lq::CouplingSchur>();
  return std::make_unique<lq::Riccati>(kind == Kind::kDense ? lq::Join::kAll : lq::Join::kIslands);
}

LqOptions chain(Lists couplings) {
  LqOptions options;
  options.couplings = [=, T = options.horizon](int k) { return k < T ? couplings : Lists{}; };
  return options;
}

class HostileProblems : public testing::TestWithParam<Kind> {
 protected:
  lq::Outcome factorize(const lq::Problem& problem, const lq::Regularisation& reg = {}) {
    solver->analyse(problem);
    return solver->factorize(problem, reg);
  }
  std::unique_ptr<lq::DirectionSolver> solver = make(GetParam());
  std::mt19937 rng{5};
};

TEST_P(HostileProblems, ControlsWithoutCostAreNotConvex) {
  LqOptions options;
  options.control_weight = options.state_weight = 0;
  lq::Problem problem = random_lq(rng, options);
  const lq::Outcome outcome = factorize(problem);
  EXPECT_EQ(outcome.status, Status::kNotConvex);
  EXPECT_EQ(outcome.knot, problem.horizon() - 1);
  EXPECT_EQ(factorize(problem, {0, 1e-6, 0}).status, Status::kOk);
}

TEST_P(HostileProblems, NegativeCurvatureIsNotConvex) {
  for (const Lists& couplings : {Lists{}, Lists{{0, 1}}}) {
    lq::Problem problem = random_lq(rng, chain(couplings));
    problem.knots[4].groups[2].R.diagonal().array() -= 50;
    const lq::Outcome outcome = factorize(problem);
    EXPECT_EQ(outcome.status, Status::kNotConvex);
    EXPECT_EQ(outcome.knot, 4);
  }
}

TEST_P(HostileProblems, NegativeCurvatureOfACoupledBlockIsNotConvex) {
  lq::Problem problem = random_lq(rng, chain({{0, 1}}));
  problem.knots[4].groups[0].R.topLeftCorner(2, 2).diagonal().array() -= 1e3;
  EXPECT_EQ(factorize(problem).status, Status::kNotConvex);
}

// Stagewise elimination stops; the KKT error of the proximal term's solution shows whether the two agree.
TEST_P(HostileProblems, TheSameCouplingTwiceIsSingularOrSolvedWhereBothAgree) {
  lq::Problem problem = random_lq(rng, chain({{0, 1}, {0, 1}}));
  const bool schur = GetParam() == Kind::kCouplingSchur;
  lq::Point z;
  for (lq::Knot& knot : problem.knots)
    for (lq::Group& g : knot.groups)
      if (g.couplings.size() == 2) {
        const auto nu = g.R.rows() - 4;
        g.C.bottomRows(2) = g.C.topRows(2);
        g.D.bottomRows(2) = g.D.topRows(2);
        g.D.rightCols(2) = g.D.middleCols(nu, 2);
        g.B.rightCols(2) = g.B.middleCols(nu, 2);
      }
  EXPECT_EQ(factorize(problem).status, schur ? Status::kOk : Status::kSingular);
  if (schur) {
    EXPECT_EQ(solver->solve(problem, z).status, Status::kInaccurate);
    for (lq::Knot& knot : problem.knots)
      for (lq::Group& g : knot.groups)
        if (g.couplings.size() == 2) {
          g.d.tail(2) = g.d.head(2);
          g.r.tail(2) = g.r.segment(g.r.size() - 4, 2);
          g.S.rightCols(2) = g.S.middleCols(g.S.cols() - 4, 2);
          g.R.rightCols(2) = g.R.middleCols(g.R.cols() - 4, 2);
          g.R.bottomRows(2) = g.R.middleRows(g.R.cols() - 4, 2);
        }
    ASSERT_EQ(factorize(problem).status, Status::kOk);
    EXPECT_EQ(solver->solve(problem, z).status, Status::kOk);
    EXPECT_LE(lq::kkt_error(problem, z), lq::kAccurate);
  }
  // With a proximal term and a cost on w the problem has one solution again.
  for (lq::Knot& knot : problem.knots)
    for (lq::Group& g : knot.groups)
      if (g.couplings.size() == 2) g.R.bottomRightCorner(4, 4).diagonal().array() += 1e-3;
  const lq::Regularisation reg{0, 0, 1e-3};
  ASSERT_EQ(factorize(problem, reg).status, Status::kOk);
  EXPECT_EQ(solver->solve(problem, z).status, Status::kOk);
  EXPECT_LE(lq::kkt_error(problem, z, reg), lq::kRefineAbove);
}

TEST_P(HostileProblems, NotANumberIsReported) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  lq::Problem problem = random_lq(rng, chain({{0, 1}}));
  for (const auto part :
       {&lq::Group::Q, &lq::Group::S, &lq::Group::R, &lq::Group::A, &lq::Group::B, &lq::Group::C, &lq::Group::D}) {
    double& entry = (problem.knots[3].groups[0].*part)(0, 0);
    const double kept = std::exchange(entry, nan);
    EXPECT_EQ(factorize(problem).status, Status::kNotFinite);
    entry = kept;
  }
  ASSERT_EQ(factorize(problem).status, Status::kOk);
  problem.knots[3].groups[0].q[0] = nan;
  lq::Point z;
  EXPECT_EQ(solver->solve(problem, z).status, Status::kNotFinite);
}

TEST_P(HostileProblems, OverflowIsReported) {
  LqOptions options;
  options.growth = 1e200;
  EXPECT_EQ(factorize(random_lq(rng, options)).status, Status::kNotFinite);
}

// kOk always means a small KKT error.
TEST_P(HostileProblems, LongUnstableHorizonsAreJudgedByTheirError) {
  for (double growth : {1.5, 3., 10.})
    for (double weight : {1., 1e-8, 0.}) {
      LqOptions options = chain({{0, 1}, {1, 2}});
      options.growth = growth;
      options.state_weight = weight;
      options.control_weight = 1e-4;
      const lq::Problem problem = random_lq(rng, options);
      if (factorize(problem).status != Status::kOk) continue;
      lq::Point z;
      const lq::Outcome outcome = solver->solve(problem, z);
      const double error = lq::kkt_error(problem, z);
      EXPECT_EQ(outcome.kkt_error, error);
      EXPECT_EQ(outcome.status == Status::kOk, error <= lq::kAccurate);
      RecordProperty("error", std::to_string(error));
    }
}

TEST_P(HostileProblems, OtherStructureIsRefused) {
  lq::Problem problem = random_lq(rng, chain({{0, 1}})), other = random_lq(rng, chain({{0, 2}}));
  lq::Point z;
  ASSERT_EQ(factorize(problem).status, Status::kOk);
  EXPECT_THROW((void)solver->factorize(other), std::invalid_argument);
  EXPECT_THROW((void)solver->solve(other, z), std::invalid_argument);
  EXPECT_EQ(solver->solve(problem, z).status, Status::kOk);
  solver->analyse(problem);
  EXPECT_THROW((void)solver->solve(problem, z), std::logic_error) << "no factor";
}

std::string title(const testing::TestParamInfo<Kind>& info) {
  const char* names[] = {"Dense", "Islands", "CouplingSchur"};
  return names[static_cast<int>(info.param)];
}
INSTANTIATE_TEST_SUITE_P(Solvers, HostileProblems, testing::Values(Kind::kDense, Kind::kIslands, Kind::kCouplingSchur),
                         title);

// ---- problems that do not fit are refused with knot and group

TEST(LqProblem, WhatDoesNotFitIsRefused) {
  std::mt19937 rng(1);
  const lq::Problem good = random_lq(rng, chain({{0, 1}}));
  EXPECT_NO_THROW(lq::check(good));
  const auto refused = [&](auto&& spoil) {
    lq::Problem problem = good;
    spoil(problem);
    EXPECT_THROW(lq::check(problem), std::invalid_argument);
  };
  refused([](lq::Problem& p) { p.knots.clear(); });
  refused([](lq::Problem& p) { p.x0.conservativeResize(1); });
  refused([](lq::Problem& p) { p.nu.pop_back(); });
  refused([](lq::Problem& p) { p.knots[1].groups[0].blocks = {7}; });
  refused([](lq::Problem& p) { p.knots[1].groups[0].blocks = {1}; });
  refused([](lq::Problem& p) { p.knots[1].groups[0].blocks.clear(); });
  refused([](lq::Problem& p) { p.knots[1].groups.pop_back(); });
  refused([](lq::Problem& p) { p.knots[1].groups[0].couplings = {3}; });
  refused([](lq::Problem& p) { p.knots[1].groups[0].couplings = {0, 0}; });
  refused([](lq::Problem& p) { p.knots[1].couplings.push_back({1, 1}); });
  refused([](lq::Problem& p) { p.knots[1].groups[0].A.resize(1, 1); });
  refused([](lq::Problem& p) { p.knots[1].groups[0].D.resize(1, 1); });
  refused([](lq::Problem& p) { p.knots[1].groups[0].d.resize(0); });
  const auto stepped = [&](int nx, lq::BlockDiagonal J) {
    lq::Problem problem = good;
    problem.nx[0] = nx;
    lq::set_zero(problem);
    problem.knots[1].groups[0].steps = lq::SymplecticStructure{J, {0.1, {}}};
    lq::check(problem);
  };
  EXPECT_NO_THROW(stepped(4, {1, {{1, Eigen::MatrixXd::Identity(1, 1)}}}));
  EXPECT_THROW(stepped(3, {1, {}}), std::invalid_argument);
  EXPECT_THROW(stepped(4, {1, {{1, Eigen::MatrixXd::Identity(2, 2)}}}), std::invalid_argument);
  EXPECT_THROW(stepped(4, {1, {{-1, Eigen::MatrixXd::Identity(1, 1)}}}), std::invalid_argument);
  EXPECT_THROW(stepped(4, {1, {{0, Eigen::MatrixXd::Zero(2, 1)}}}), std::invalid_argument);
  EXPECT_THROW(stepped(14, {1, {{0, Eigen::MatrixXd::Identity(7, 7)}}}), std::invalid_argument);
  EXPECT_THROW(stepped(6, {1, {{0, Eigen::MatrixXd::Identity(2, 2)}, {1, Eigen::MatrixXd::Identity(1, 1)}}}),
               std::invalid_argument);
}

// ---- the choice by predicted operations

TEST(LqChoice, SeparateBlocksTakeRiccatiByIslandsAndChainsOfBigBlocksTheSchurComplement) {
  std::mt19937 rng(1);
  LqOptions options;
  options.nx = {20, 20, 20, 20, 20, 20, 20, 20};
  options.nu = {8, 8, 8, 8, 8, 8, 8, 8};
  const lq::Problem separate = random_lq(rng, options);
  const lq::Prediction p = lq::predict(separate);
  EXPECT_NEAR(p.dense / p.islands, 64, 64);
  EXPECT_STREQ(lq::choose(separate)->name(), "Riccati by islands");
  const lq::Problem chain = chain_of_robots(8, 10, rng, 20, 8, 2);
  const lq::Prediction q = lq::predict(chain);
  EXPECT_GT(q.islands, 2 * q.coupling_schur);
  EXPECT_EQ(q.islands, q.dense);
  EXPECT_STREQ(lq::choose(chain)->name(), "Schur complement of couplings");
  const lq::Problem pair = chain_of_robots(2, 40, rng, 4, 2, 4);
  EXPECT_STREQ(lq::choose(pair)->name(), "Riccati by islands");
}

}  // namespace
}  // namespace manycontact::test
