// The sparse solver has tasks of several robots: separate ones, and ones that contacts couple for a while.

#include "manycontact/detail/control/sparse.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <random>
#include <regex>
#include <sstream>

#include "manycontact/control/euler.hpp"
#include "manycontact/control/riccati_direction.hpp"
#include "manycontact/task/forces.hpp"
#include "manycontact/task/optimize.hpp"
#include "manycontact/task/parts.hpp"
#include "spatial/compare.hpp"
#include "support/folder.hpp"
#include "support/random.hpp"
#include "support/scenes.hpp"
#include "task/task_of.hpp"

namespace manycontact::test {
namespace {

// Returns quadrupeds on a circle, each rotated its own way. `more`: robots and contacts.
std::string herd_scene(int robots, const std::string& more = "", const std::string& urdf = kModels + "quadruped.urdf") {
  std::string out = "<scene name='herd'><robot name='herd' urdf='" + urdf +
                    "' base='floating' xyz='0 0 0.3824' copies='" + std::to_string(robots) +
                    "' arrange='circle' spacing='1'>";
  for (const char* leg : {"LF", "RF", "LH", "RH"})
    out += std::string("<joint name='") + leg + "_hip' q='0.7'/><joint name='" + leg + "_knee' q='-1.4'/>";
  out += "</robot>";
  for (const char* leg : {"LF", "RF", "LH", "RH"})
    out += std::string("<contact name='") + leg + "' type='3d' frame='herd/" + leg + "_foot' gains='0 20'/>";
  return out + more + "</scene>";
}

// Returns terms of all kinds; they apply to every copy.
std::string costs(const std::string& swing) {
  return "<cost name='state' type='state' weight='1' robot='herd' weights='" + repeated("0.1", 6) +
         repeated("0.5", 12) + repeated("0.2", 18) +
         "'/>"
         "<cost name='control' type='control' weight='1e-3'/>"
         "<cost name='com' type='com' robot='herd' weight='10' reference='0.02 0.01 0.36'/>"
         "<cost name='turn' type='frame_rotation' frame='herd/trunk' weight='5' quat_xyzw='0 0 0.05 0.99875'/>"
         "<cost name='still' type='frame_velocity' frame='herd/trunk' reference_frame='local_world_aligned'"
         " twist='0.1 0 0 0 0 0' weight='0.5'/>"
         "<cost name='cone' type='friction_cone' contact='RF' mu='0.6' weight='1'/>" +
         swing;
}

const std::string kSwing =
    "<cost name='swing' type='frame_translation' frame='herd/LF_foot' xyz='0.3 0.2 0.08' weight='100'/>";
const std::string kReachAtTheEnd =
    "<terminal><cost name='state' type='state' weight='10'/>"
    "<cost name='reach' type='frame_translation' frame='herd/LF_foot' xyz='0.3 0.2 0.05' weight='50'/></terminal>";

TaskFile separate_task(int robots) {
  return task_of("separate" + std::to_string(robots), herd_scene(robots),
                 "<phase nodes='4' contacts='LF RF LH RH'>" + costs("") +
                     "</phase><phase nodes='6' contacts='RF LH RH'>" + costs(kSwing) + "</phase>" + kReachAtTheEnd);
}

// The first two are attached to each other in the middle, then released; the third is separate.
TaskFile joined_task() {
  return task_of("joined",
                 herd_scene(3,
                            "<contact name='hold' type='3d' frame='herd0/LH_foot' to='herd1/RF_hip_link' gains='0 20'/>"
                            "<contact name='never' type='3d' frame='herd1/LH_foot' to='herd2/trunk'/>"),
                 "<phase nodes='3' contacts='RF LH RH'>" + costs(kSwing) +
                     "</phase><phase nodes='4' contacts='RF RH hold'>" +
                     costs("<cost name='pull' type='contact_force' contact='hold' weight='1e-3' reference='1 2 3'/>") +
                     "</phase><phase nodes='3' contacts='RF LH RH'>" + costs(kSwing) + "</phase>" + kReachAtTheEnd);
}

// Contains the solutions of the whole scene and by parts.
struct Both {
  TaskSolution dense, sparse;
};

Both expect_dense_iterates(const TaskFile& task, std::size_t parts, TaskSolver of_whole = TaskSolver::kFddp,
                           TaskSolver of_parts = TaskSolver::kSparse, std::size_t blocks = 0) {
  TaskProblem whole = make_problem(task, TaskSolver::kFddp), by_parts = make_problem(task, of_parts);
  EXPECT_EQ(by_parts.parts.size(), parts);
  for (std::size_t t = 0; t < whole.us.size(); ++t)
    if (whole.us[t].size() > 0) {
      EXPECT_LT(difference_of(by_parts.us[t], whole.us[t]), 1e-9);
    }
  const Both both{optimize(task, whole, {of_whole, 1, {}}), optimize(task, by_parts, {of_parts, 1, {}})};
  const TaskSolution &dense = both.dense, &sparse = both.sparse;
  EXPECT_EQ(sparse.solver, to_string(of_parts));
  EXPECT_EQ(sparse.blocks.size(), blocks > 0 ? blocks : parts);
  EXPECT_EQ(dense.blocks.size(), 1u);
  EXPECT_EQ(sparse.converged, dense.converged) << dense.reason << ", " << sparse.reason;
  EXPECT_LT(sparse.kkt_residual, 2 * dense.kkt_residual + 1e-9);
  EXPECT_EQ(sparse.iterations.size(), dense.iterations.size());
  EXPECT_GE(dense.iterations.size(), 3u);
  for (std::size_t k = 0; k < std::min(sparse.iterations.size(), dense.iterations.size()); ++k) {
    SCOPED_TRACE("iteration " + std::to_string(k));
    const TaskIteration &s = sparse.iterations[k], &d = dense.iterations[k];
    EXPECT_NEAR(s.cost, d.cost, 1e-9 * d.cost);
    if (d.stop < 1e-6) continue;  // rounding decides
    EXPECT_NEAR(s.stop, d.stop, 1e-6 * d.stop);
    // Step lengths are a half, a quarter, ...; quasi-Newton's are interpolated between costs, whose differences have
    // fewer digits.
    EXPECT_NEAR(s.step_length, d.step_length, 1e-3 * d.step_length);
    EXPECT_EQ(s.regularisation, d.regularisation);
    EXPECT_EQ(s.feasible, d.feasible);
    EXPECT_NEAR(s.gaps, d.gaps, 1e-9 * d.gaps + 1e-12);
  }
  for (std::size_t t = 0; t < dense.xs.size(); ++t) EXPECT_LT(difference_of(sparse.xs[t], dense.xs[t]), 1e-7);
  for (std::size_t t = 0; t < dense.us.size(); ++t)
    if (dense.us[t].size() > 0) {
      EXPECT_LT(difference_of(sparse.us[t], dense.us[t]), 1e-6);
    }
  return both;
}

TEST(SparseTask, SeparateRobotsTakeTheStepsOfDenseRiccati) { expect_dense_iterates(separate_task(3), 3); }
TEST(SparseTask, RobotsThatHoldEachOtherForAWhileTakeTheStepsOfDenseRiccati) {
  expect_dense_iterates(joined_task(), 2);
}

// A falling box has no torques: it is a part of its own, whose nodes have no controls.
TEST(SparseTask, WhatHasNoTorquesMovesToo) {
  const TaskFile task =
      task_of("passive", herd_scene(2, "<robot name='box' urdf='" + kModels + "box.urdf' xyz='5 0 3'/>"),
              "<phase nodes='8' contacts='LF RF LH RH'>" + costs("") + "</phase>" + kReachAtTheEnd);
  EXPECT_EQ(separate_robots(task), (std::vector<std::vector<int>>{{0}, {1}, {2}}));
  const Both both = expect_dense_iterates(task, 3, TaskSolver::kFddp, TaskSolver::kSparse, 3);
  EXPECT_LT(both.sparse.xs.back()[task.scene.scene.robots[2].idx_q + 2], 2.98);
}

// Nodes without any controls are terminal ones, in parts too.
TEST(SparseTask, RobotsWithoutTorquesAreAsInOneScene) {
  const TaskFile task = task_of("boxes",
                                "<scene name='boxes'><robot name='box' urdf='" + kModels +
                                    "box.urdf' base='floating' copies='2' xyz='0 0 1'/></scene>",
                                "<phase nodes='4'><cost name='state' type='state' weight='1' robot='box'/></phase>");
  TaskProblem whole = make_problem(task, TaskSolver::kFddp), by_parts = make_problem(task, TaskSolver::kSparse);
  EXPECT_EQ(by_parts.parts.size(), 2u);
  const TaskSolution dense = optimize(task, whole, {TaskSolver::kFddp, 1, {}}),
                     sparse = optimize(task, by_parts, {TaskSolver::kSparse, 1, {}});
  EXPECT_EQ(sparse.converged, dense.converged) << sparse.reason;
  ASSERT_EQ(sparse.xs.size(), dense.xs.size());
  EXPECT_NEAR(sparse.cost, dense.cost, 1e-12 * dense.cost);
  for (std::size_t t = 0; t < dense.xs.size(); ++t) EXPECT_LT(difference_of(sparse.xs[t], dense.xs[t]), 1e-12);
}

TEST(SparseTask, ImpactsOfSeparateRobots) {
  const TaskFile task = task_of("impacts", herd_scene(2),
                                "<phase nodes='5' contacts='RF LH RH'>" + costs(kSwing) +
                                    "</phase><phase nodes='4' contacts='LF RF LH RH' impact='true'>" + costs("") +
                                    "</phase>" + kReachAtTheEnd);
  const Both both = expect_dense_iterates(task, 2);
  EXPECT_EQ(both.sparse.us[5].size(), 0);
  EXPECT_GT((both.sparse.xs[6] - both.sparse.xs[5]).norm(), 0.1);  // the two robots' velocities change
}

// Many torques are at their limits. The box QP of all is that of each; each is solved exactly once its active set is
// found, so that iterates agree as without limits.
TEST(SparseTask, LimitsOfSeparateRobotsTakeTheStepsOfBoxFDDP) {
  std::ostringstream urdf;
  urdf << std::ifstream(kModels + "quadruped.urdf").rdbuf();
  const TemporaryFolder folder;
  const std::string weak =
      folder.write("weak.urdf", std::regex_replace(urdf.str(), std::regex("effort=\"[^\"]*\""), "effort=\"17\""));
  const TaskFile task =
      task_of("limits", herd_scene(3, "", weak),
              "<phase nodes='4' contacts='LF RF LH RH'>" + costs("") + "</phase><phase nodes='6' contacts='RF LH RH'>" +
                  costs(kSwing) + "</phase>" + kReachAtTheEnd);
  const Both both = expect_dense_iterates(task, 3, TaskSolver::kBoxFddp, TaskSolver::kBoxFddp);
  EXPECT_TRUE(both.sparse.converged) << both.sparse.reason;
  EXPECT_EQ(both.sparse.blocks, (std::vector<int>{12, 12, 12}));
  int at_limit = 0;
  for (const Eigen::VectorXd& u : both.sparse.us) {
    EXPECT_LE(u.lpNorm<Eigen::Infinity>(), 17);
    at_limit += static_cast<int>((u.array().abs() == 17).count());
  }
  EXPECT_GT(at_limit, 10);
}

// At the end a centre of mass is exact in y and bounded in x; on the way torques are at most 20 Nm, which binds.
// Penalties are common to all robots.
TEST(SparseTask, ConstraintsOfSeparateRobotsTakeTheStepsOfTheWholeScene) {
  const std::string on_the_way = "<constraint name='weak' type='control' robot='herd' lower='" + repeated("-20", 12) +
                                 "' upper='" + repeated("20", 12) + "'/>";
  for (const TaskSolver whole : {TaskSolver::kFddp, TaskSolver::kBoxFddp}) {
    const TaskFile task = task_of(
        "constrained", herd_scene(2),
        "<phase nodes='12' contacts='LF RF LH RH'>" + costs("") + on_the_way +
            "</phase><terminal><cost name='state' type='state' weight='10'/><constraint name='com' type='com' "
            "robot='herd' reference='-0.016 0.002 0.34' lower='-0.001 0 -0.01' upper='0.001 0 0.01'/></terminal>"
            "<solver iterations='200' tolerance='1e-14'/>");
    const Both both = expect_dense_iterates(task, 2, whole, whole == TaskSolver::kFddp ? TaskSolver::kSparse : whole);
    const TaskSolution &sparse = both.sparse, &dense = both.dense;
    EXPECT_TRUE(sparse.converged) << sparse.reason;
    EXPECT_LE(sparse.constraint_violation, 1e-8);
    EXPECT_LT(sparse.kkt_residual, 1e-6);
    EXPECT_GT(sparse.outer_iterations, 2u);
    EXPECT_EQ(sparse.outer_iterations, dense.outer_iterations);
    double most = 0;
    for (const Eigen::VectorXd& u : sparse.us) most = std::max(most, u.lpNorm<Eigen::Infinity>());
    EXPECT_NEAR(most, 20, 1e-8);
    ASSERT_EQ(sparse.violations.size(), 3u);  // named as in the whole scene: com0, com1, weak
    for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(sparse.violations[k].constraint, dense.violations[k].constraint);
  }
}

// Expects the same steps k and gains K at one candidate with gaps.
void expect_dense_direction(const TaskFile& task) {
  const TaskProblem whole = make_problem(task, TaskSolver::kFddp), by_parts = make_problem(task, TaskSolver::kSparse);
  SolverFDDP dense(whole.problem);
  SolverSparse sparse(by_parts.problem);
  std::mt19937 rng(1);
  std::vector<Eigen::VectorXd> xs = whole.xs, us = whole.us;
  for (Eigen::VectorXd& x : xs)
    x = whole.state->integrate_x(x, random_vector(static_cast<int>(whole.state->get_ndx()), rng, 0.05));
  for (Eigen::VectorXd& u : us) u += random_vector(static_cast<int>(u.size()), rng, 1);
  for (SolverAbstract* solver : {static_cast<SolverAbstract*>(&dense), static_cast<SolverAbstract*>(&sparse)}) {
    solver->setCandidate(xs, us, false);
    solver->set_preg(1e-9);
    solver->computeDirection(true);
  }
  ASSERT_TRUE(dense.direction_is_sound());
  ASSERT_TRUE(sparse.direction_is_sound());
  for (std::size_t t = 0; t < us.size(); ++t) {
    Eigen::MatrixXd K = dense.get_K()[t];
    const double largest = K.lpNorm<Eigen::Infinity>();
    for (const auto& direction : sparse.directions()) {
      const auto* own = dynamic_cast<const RiccatiDirection*>(direction.get());
      ASSERT_NE(own, nullptr);
      const ShootingPart& part = own->part();
      EXPECT_LT(error_of(own->get_k()[t], Eigen::VectorXd(dense.get_k()[t](part.u[t]))), 1e-9) << t;
      EXPECT_LT(error_of(own->get_K()[t], Eigen::MatrixXd(dense.get_K()[t](part.u[t], part.dx))), 1e-9) << t;
      K(part.u[t], part.dx).setZero();
    }
    EXPECT_LT(K.lpNorm<Eigen::Infinity>(), 1e-9 * largest) << t;
  }
}

TEST(SparseTask, DirectionsOfSeparateRobots) { expect_dense_direction(separate_task(2)); }
TEST(SparseTask, DirectionsOfRobotsThatHoldEachOther) { expect_dense_direction(joined_task()); }

TEST(SparseTask, PartsAreJoinedByContactsThatAreUsedAndByTermsOfAll) {
  using Parts = std::vector<std::vector<int>>;
  EXPECT_EQ(separate_robots(separate_task(4)), (Parts{{0}, {1}, {2}, {3}}));
  EXPECT_EQ(separate_robots(joined_task()), (Parts{{0, 1}, {2}}));
  const TaskFile all =
      task_of("all", herd_scene(3),
              "<phase nodes='2' contacts='LF RF LH RH'><cost name='com' type='com' reference='0 0 0.3'/>"
              "</phase>" +
                  kReachAtTheEnd);
  EXPECT_EQ(separate_robots(all), (Parts{{0, 1, 2}}));
}

TEST(SparseTask, AutoTakesPartsWhereThereAreSome) {
  const TaskFile task = separate_task(2);
  TaskProblem problem = make_problem(task, TaskSolver::kAuto);
  const TaskSolution solution = optimize(task, problem, {TaskSolver::kAuto, 1, {}});
  EXPECT_EQ(solution.solver, "sparse");
  EXPECT_EQ(solution.blocks, (std::vector<int>{12, 12}));
  const TaskFile one = separate_task(1);
  problem = make_problem(one, TaskSolver::kAuto);
  EXPECT_EQ(optimize(one, problem, {TaskSolver::kAuto, 1, {}}).solver, "fddp");
}

TEST(SparseTask, ForcesAreThoseOfTheWholeScene) {
  const TaskFile task = joined_task();
  const TaskProblem whole = make_problem(task, TaskSolver::kFddp), by_parts = make_problem(task, TaskSolver::kSparse);
  for (const TaskProblem* problem : {&whole, &by_parts}) problem->problem->calc(whole.xs, whole.us);
  for (const std::size_t t : {0u, 5u}) {
    const std::vector<Eigen::VectorXd> ours = contact_forces(task, by_parts, t), dense = contact_forces(task, whole, t);
    ASSERT_EQ(ours.size(), dense.size());
    for (std::size_t c = 0; c < dense.size(); ++c) {
      ASSERT_EQ(ours[c].size(), dense[c].size()) << c;
      if (dense[c].size() > 0) {
        EXPECT_LT(difference_of(ours[c], dense[c]), 1e-9) << c;
      }
    }
  }
}

// Returns the count of numbers that nodes store in matrices.
Eigen::Index numbers_of(const ActionDataAbstract& d) {
  Eigen::Index count = d.Fx.size() + d.Fu.size() + d.Lxx.size() + d.Lxu.size() + d.Luu.size();
  if (const auto* euler = dynamic_cast<const IntegratedActionDataEuler*>(&d)) {
    const DifferentialActionDataAbstract& own = *euler->differential;
    count += own.panel.size() + own.Lxx_sparse().nonZeros() + own.Lxu_sparse().nonZeros() + own.Luu_sparse().nonZeros();
  }
  if (const auto* parts = dynamic_cast<const ActionDataParts*>(&d))
    for (const auto& own : parts->parts) count += numbers_of(*own);
  return count;
}

TEST(SparseTask, MemoryIsLinearInTheRobots) {
  const auto count = [](int robots) {
    const TaskProblem made = make_problem(separate_task(robots), TaskSolver::kSparse);
    made.problem->calc(made.xs, made.us);
    made.problem->calcDiff(made.xs, made.us);
    return numbers_of(*made.problem->get_runningDatas()[0]);
  };
  const Eigen::Index two = count(2);
  EXPECT_GE(two, 2 * 18 * (36 + 12));
  EXPECT_EQ(count(4), 2 * two);
  EXPECT_EQ(2 * count(5), 5 * two);
}

TEST(SparseTask, GivesTheSameBitsForAnyNumberOfThreads) {
  const TaskFile task = joined_task();
  std::vector<TaskSolution> solutions;
  for (const int threads : {1, 2}) {
    TaskProblem problem = make_problem(task, TaskSolver::kSparse);
    solutions.push_back(optimize(task, problem, {TaskSolver::kSparse, threads, {}}));
  }
  for (const TaskSolution& s : solutions) {
    EXPECT_EQ(s.cost, solutions[0].cost);
    EXPECT_TRUE(s.xs == solutions[0].xs);
    EXPECT_TRUE(s.us == solutions[0].us);
  }
}

// On a receding horizon the parts stay, and the numbers are those of a solver made for the shifted nodes.
TEST(SparseTask, PartsFollowAHorizonThatMoves) {
  const TaskFile task = separate_task(2);
  const TaskProblem moved = make_problem(task, TaskSolver::kSparse);
  SolverSparse solver(moved.problem);
  (void)solver.solve(moved.xs, moved.us, 2);
  const std::vector<const Direction*> parts = {solver.directions()[0].get(), solver.directions()[1].get()};
  std::vector<Eigen::VectorXd> us = moved.us;
  for (int shift = 0; shift < 5; ++shift) {  // phases end and begin: the first four nodes have another foot down
    ShootingProblem& horizon = *moved.problem;
    horizon.circularAppend(horizon.get_runningModels()[0], horizon.get_runningDatas()[0]);
    std::rotate(us.begin(), us.begin() + 1, us.end());
    (void)solver.solve(moved.xs, us, 2);
    SolverSparse afresh(moved.problem);
    (void)afresh.solve(moved.xs, us, 2);
    EXPECT_EQ(solver.get_cost(), afresh.get_cost());
    EXPECT_TRUE(solver.get_xs() == afresh.get_xs());
    EXPECT_TRUE(solver.get_us() == afresh.get_us());
  }
  for (std::size_t i = 0; i < parts.size(); ++i) EXPECT_EQ(solver.directions()[i].get(), parts[i]);
}

}  // namespace
}  // namespace manycontact::test
