// Robots attached to each other are separated at their contacts: nodes, directions and motions agree with those of the
// whole scene.

#include "manycontact/task/joined.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <random>

#include "manycontact/control/box_solvers.hpp"
#include "manycontact/control/callbacks.hpp"
#include "manycontact/control/coupled_direction.hpp"
#include "manycontact/control/kkt_residual.hpp"
#include "manycontact/detail/control/couplings.hpp"
#include "manycontact/detail/control/sparse.hpp"
#include "manycontact/task/forces.hpp"
#include "manycontact/task/parts.hpp"
#include "manycontact/task/simulate.hpp"
#include "spatial/compare.hpp"
#include "support/allocations.hpp"
#include "support/dense.hpp"
#include "support/random.hpp"
#include "support/scenes.hpp"
#include "task/task_of.hpp"

namespace manycontact::test {
namespace {

// Returns quadrupeds in a line, each with a front foot on the trunk of the next: couplings in one frame or the other.
std::string chain_scene(int robots, const std::string& frame = "local", const std::string& damping = "0",
                        const std::string& type = "6d") {
  std::string out = "<scene name='chain' damping='" + damping + "'><robot name='q' urdf='" + kModels +
                    "quadruped.urdf' base='floating' xyz='0 0 0.3824' copies='" + std::to_string(robots) +
                    "' arrange='line' spacing='1'>";
  for (const char* leg : {"LF", "RF", "LH", "RH"})
    out += std::string("<joint name='") + leg + "_hip' q='0.7'/><joint name='" + leg + "_knee' q='-1.4'/>";
  out += "</robot>";
  for (const char* leg : {"RF", "LH", "RH"})
    out += std::string("<contact name='") + leg + "' type='3d' frame='q/" + leg + "_foot' gains='0 20'/>";
  return out + "<contact name='hold' type='" + type +
         "' frame='q/LF_foot' to='q+1/trunk' gains='40 15' reference_frame='" + frame + "'/></scene>";
}

const std::string kCosts =
    "<cost name='state' type='state' weight='1' robot='q' weights='" + repeated("0.1", 6) + repeated("0.5", 12) +
    repeated("0.2", 18) +
    "'/><cost name='control' type='control' weight='1e-3'/>"
    "<cost name='com' type='com' robot='q' weight='10' reference='0.02 0.01 0.36'/>"
    "<cost name='acceleration' type='joint_acceleration' robot='q' weight='1e-4'/>"
    "<cost name='cone' type='friction_cone' contact='RF' mu='0.6' weight='1'/>"
    "<cost name='turn' type='frame_rotation' frame='q/trunk' weight='5' quat_xyzw='0 0 0.05 0.99875'/>";
const std::string kTerminal = "<terminal><cost name='state' type='state' weight='10'/></terminal>";

// Robots are coupled in the second phase alone. `more`: terms of that phase.
TaskFile chain(int robots, const std::string& frame = "local", const std::string& damping = "0",
               const std::string& type = "6d", const std::string& more = "", const std::string& terminal = kTerminal) {
  return task_of("chain" + std::to_string(robots) + frame + damping + type, chain_scene(robots, frame, damping, type),
                 "<phase nodes='3' contacts='RF LH RH'>" + kCosts +
                     "</phase><phase nodes='4' contacts='RF LH RH hold'>" + kCosts + more + "</phase>" + terminal);
}

TaskFile always(int robots, int nodes) {
  return task_of(
      "always" + std::to_string(robots), chain_scene(robots, "local_world_aligned"),
      "<phase nodes='" + std::to_string(nodes) + "' contacts='RF LH RH hold'>" + kCosts + "</phase>" + kTerminal);
}

struct Candidate {
  std::vector<Eigen::VectorXd> xs, us;
};
Candidate random_candidate(const TaskProblem& problem, unsigned seed, double size = 0.2) {
  std::mt19937 rng(seed);
  Candidate out{problem.xs, problem.us};
  for (Eigen::VectorXd& x : out.xs)
    x = problem.state->integrate_x(x, random_vector(static_cast<int>(problem.state->get_ndx()), rng, size));
  for (Eigen::VectorXd& u : out.us) u += random_vector(static_cast<int>(u.size()), rng, 5);
  return out;
}

// Returns the chain in its second phase, with wrenches, and with springs of its own for each robot.
TaskFile pushed_chain(int robots) {
  std::string scene = chain_scene(robots);
  scene.resize(scene.size() - std::string("</scene>").size());
  scene +=
      "<push name='wind' frame='q/trunk' offset='0.1 0 0' force='5 3 -2' torque='0 1 0' reference_frame='world'/>"
      "<push frame='q0/LF_foot' force='0 0 4'/>"
      "<spring frame='q/trunk' xyz='0 0 1' stiffness='30' damping='2'/>"
      "<spring frame='q/LF_foot' to='q/trunk' to_offset='0 0 0.1' stiffness='20'/></scene>";
  return task_of("pushed" + std::to_string(robots), scene,
                 "<phase nodes='3' contacts='RF LH RH'>" + kCosts +
                     "</phase><phase nodes='4' contacts='RF LH RH hold'><push name='wind' force='-7 0 1'/>" + kCosts +
                     "</phase>" + kTerminal);
}

TEST(Joined, PushesOfPhases) {
  const TaskFile task = pushed_chain(3);
  ASSERT_EQ(task.scene.scene.wrenches.size(), 4u);
  for (int k = 0; k < 3; ++k) {
    const Vec6<double>& w = task.phases[1].wrenches[static_cast<std::size_t>(k)];
    EXPECT_EQ(w, (Vec6<double>() << -7, 0, 1, 0, 1, 0).finished());
  }
  EXPECT_EQ(task.phases[0].wrenches[2][0], 5);
  EXPECT_EQ(task.phases[1].wrenches[3][2], 4);
  const TaskFile part = part_of(task, {1, 2});
  EXPECT_EQ(part.scene.scene.wrenches.size(), 2u);
  EXPECT_EQ(part.phases[1].wrenches.size(), 2u);
  EXPECT_EQ(part.scene.scene.springs.size(), 4u);
}

// ---- nodes ------------------------------------------------------------------------------------------------------

void expect_nodes_of_the_whole(const TaskFile& task, std::size_t blocks) {
  const TaskProblem whole = make_problem(task, TaskSolver::kFddp), joined = make_problem(task, TaskSolver::kSparse);
  ASSERT_EQ(joined.parts.size(), 1u);
  ASSERT_EQ(joined.blocks.size(), blocks);
  const Candidate at = random_candidate(whole, 1);
  for (const std::size_t t : {std::size_t(0), whole.us.size() - 1, whole.us.size()}) {
    SCOPED_TRACE("node " + std::to_string(t));
    const auto& parts = dynamic_cast<const ActionModelParts&>(*joined.problem->model(t)).get_parts();
    const auto model = std::dynamic_pointer_cast<ActionModelParts>(parts.at(0).model);
    ASSERT_TRUE(model);
    EXPECT_TRUE(model->get_couplings());
    model->set_storage(MatrixStorage::kDense);
    const auto data = model->createData(), expected = whole.problem->data(t);
    EXPECT_TRUE(model->checkData(data));
    ActionModelAbstract& reference = *whole.problem->model(t);
    if (t < whole.us.size()) {
      reference.calc(expected, at.xs[t], at.us[t]);
      reference.calcDiff(expected, at.xs[t], at.us[t]);
      model->calc(data, at.xs[t], at.us[t]);
      model->calcDiff(data, at.xs[t], at.us[t]);
    } else {
      reference.calc(expected, at.xs[t]);
      reference.calcDiff(expected, at.xs[t]);
      model->calc(data, at.xs[t]);
      model->calcDiff(data, at.xs[t]);
    }
    EXPECT_NEAR(data->cost, expected->cost, 1e-11 * expected->cost);
    EXPECT_LT(difference_of(data->xnext, expected->xnext), 1e-11);
    EXPECT_LT(error_of(data->Fx, expected->Fx), 1e-10);
    EXPECT_LT(error_of(data->Lx, expected->Lx), 1e-10);
    EXPECT_LT(error_of(data->Lxx, expected->Lxx), 1e-10);
    if (t == whole.us.size()) continue;
    EXPECT_LT(error_of(data->Fu, expected->Fu), 1e-10);
    EXPECT_LT(error_of(data->Lu, expected->Lu), 1e-10);
    EXPECT_LT(error_of(data->Lxu, expected->Lxu), 1e-10);
    EXPECT_LT(error_of(data->Luu, expected->Luu), 1e-10);
    ASSERT_EQ(data->g.size(), expected->g.size());
    ASSERT_EQ(data->h.size(), expected->h.size());
    EXPECT_EQ(model->get_g_lb(), reference.get_g_lb());
    EXPECT_EQ(model->get_g_ub(), reference.get_g_ub());
    if (data->g.size() == 0) continue;
    EXPECT_LT(error_of(data->g, expected->g), 1e-10);
    EXPECT_LT(error_of(data->h, expected->h), 1e-10);
    EXPECT_LT(error_of(data->Gx, expected->Gx), 1e-10);
    EXPECT_LT(error_of(data->Gu, expected->Gu), 1e-10);
    EXPECT_LT(error_of(data->Hx, expected->Hx), 1e-10);
    EXPECT_LT(error_of(data->Hu, expected->Hu), 1e-10);
  }
}

// A constraint on the force of each robot's foot, which the couplings' wrenches affect: one inequality, one equality.
const std::string kPush =
    "<constraint name='push' type='contact_force' contact='RF' lower='3 -inf 40' upper='3 inf inf'/>";
TEST(JoinedNodes, WithConstraints) { expect_nodes_of_the_whole(chain(3, "local", "0", "6d", kPush), 3); }

TEST(JoinedNodes, AreThoseOfTheWholeScene) { expect_nodes_of_the_whole(chain(3), 3); }
TEST(JoinedNodes, WithFramesInTheWorld) { expect_nodes_of_the_whole(chain(2, "local_world_aligned"), 2); }
TEST(JoinedNodes, OfContactsOfFewerRows) {
  for (const char* type : {"1d", "2d", "3d", "5d"})
    for (const char* frame : {"local", "local_world_aligned"}) {
      if (std::string(type) == "5d" && frame[5] != 0) continue;  // the axis belongs to both bodies
      SCOPED_TRACE(std::string(type) + " " + frame);
      expect_nodes_of_the_whole(chain(2, frame, "0", type), 2);
      expect_nodes_of_the_whole(chain(2, frame, "1e-3", type), 2);
    }
}
TEST(JoinedNodes, WithPushesAndSprings) { expect_nodes_of_the_whole(pushed_chain(3), 3); }
TEST(JoinedNodes, WithDamping) { expect_nodes_of_the_whole(chain(2, "local", "1e-3"), 2); }
TEST(JoinedNodes, WithDampingAndFramesInTheWorld) { expect_nodes_of_the_whole(chain(2, "world", "1e-3"), 2); }

// ---- directions -------------------------------------------------------------------------------------------------

// Contains the step (dx, du) of SolverFDDP's gains on the linear model.
struct Step {
  std::vector<Eigen::VectorXd> x, u;
};
Step step_of(const SolverFDDP& solver) {
  const ShootingProblem& problem = *solver.get_problem();
  Step out;
  out.x.push_back(solver.get_fs()[0]);
  for (std::size_t t = 0; t < problem.get_T(); ++t) {
    const ActionDataAbstract& data = *problem.data(t);
    out.u.push_back(-solver.get_k()[t] - solver.get_K()[t] * out.x[t]);
    out.x.push_back(data.Fx * out.x[t] + data.Fu * out.u[t] + solver.get_fs()[t + 1]);
  }
  return out;
}

void expect_dense_direction(const TaskFile& task, const std::string& way, double size = 0.2) {
  const TaskProblem whole = make_problem(task, TaskSolver::kFddp), joined = make_problem(task, TaskSolver::kSparse);
  SolverFDDP dense(whole.problem);
  SolverSparse sparse(joined.problem);
  const Candidate at = random_candidate(whole, 2, size);
  for (SolverAbstract* solver : {static_cast<SolverAbstract*>(&dense), static_cast<SolverAbstract*>(&sparse)}) {
    solver->setCandidate(at.xs, at.us, false);
    solver->set_preg(1e-9);
    solver->set_dreg(1e-9);
    solver->computeDirection(true);
  }
  ASSERT_TRUE(dense.direction_is_sound());
  ASSERT_TRUE(sparse.direction_is_sound());
  EXPECT_EQ(sparse.direction(), way);
  // SolverFDDP does not refine: its own error grows with the condition of Quu.
  double condition = 1;
  for (const Eigen::MatrixXd& Quu : dense.get_Quu()) {
    const Eigen::VectorXd values = eigenvalues(Quu);
    condition = std::max(condition, values.maxCoeff() / values.minCoeff());
  }
  const double tolerance = std::max(1e-9, kEps * condition);
  const Step expected = step_of(dense);
  const auto& part = dynamic_cast<const CoupledDirection&>(*sparse.directions().at(0));
  const lq::Point& z = part.solution_of_direction();
  const auto& parts = dynamic_cast<const ActionModelParts&>(*part.part().problem->get_terminalModel()).get_parts();
  for (std::size_t t = 0; t < z.x.size(); ++t) {
    Eigen::VectorXd dx(z.x[t].size());
    Eigen::Index first = 0;
    for (const ActionPart& own : parts)
      for (const int i : own.dx) dx[i] = z.x[t][first++];
    EXPECT_LT(error_of(dx, expected.x[t]), tolerance) << t;
    if (t == expected.u.size()) continue;
    EXPECT_LT(error_of(Eigen::VectorXd(-sparse.get_k()[t]), expected.u[t]), tolerance) << t;
  }

  lq::Riccati oracle(lq::Join::kAll);
  oracle.analyse(part.problem_of_direction());
  ASSERT_EQ(oracle.factorize(part.problem_of_direction(), {1e-9, 1e-9, 0}).status, lq::Status::kOk);
  lq::Point refined;
  ASSERT_EQ(oracle.solve(part.problem_of_direction(), refined).status, lq::Status::kOk);
  for (std::size_t t = 0; t < expected.u.size(); ++t) {
    EXPECT_LT(error_of(z.x[t + 1], refined.x[t + 1]), 1e-9) << t;
    EXPECT_LT(error_of(z.u[t], refined.u[t]), 1e-9) << t;
    if (z.w[t].size() > 0) {
      EXPECT_LT(error_of(z.w[t], refined.w[t]), 1e-9) << t;
    }
  }
}

TEST(JoinedDirections, OfAChainBySchurComplement) { expect_dense_direction(chain(5), "Schur complement of couplings"); }
TEST(JoinedDirections, OfContactsOfFewerRows) {
  for (const char* type : {"1d", "2d", "3d", "5d"}) {
    SCOPED_TRACE(type);
    expect_dense_direction(chain(5, "local", "0", type), "Schur complement of couplings");
    expect_dense_direction(chain(2, "local", "0", type), "Riccati by islands");
  }
}
TEST(JoinedDirections, OfAChainByIslands) { expect_dense_direction(always(2, 5), "Riccati by islands"); }

// Returns humanoids hand in hand, as in models/ring_of_humanoids.xml.
TaskFile humanoids(int robots, bool closed, int nodes) {
  std::ifstream file(kModels + "ring_of_humanoids.xml");
  std::string scene((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  const auto replace = [&](const std::string& from, const std::string& to) {
    const std::size_t at = scene.find(from);
    ASSERT_NE(at, std::string::npos) << from;
    scene.replace(at, from.size(), to);
  };
  replace("urdf=\"humanoid.urdf\"", "urdf=\"" + kModels + "humanoid.urdf\"");
  replace("copies=\"16\"", "copies=\"" + std::to_string(robots) + "\"");
  if (!closed) replace(" wrap=\"true\"", "");
  const std::string costs =
      "<cost name='state' type='state' robot='ring'/><cost name='control' type='control' weight='1e-3'/>"
      "<cost name='com' type='com' robot='ring' weight='100' reference='0.02 0 0.7'/>"
      "<cost name='sole' type='wrench_cone' contact='left' mu='0.6' box='0.2 0.09'/>";
  return task_of("humanoids" + std::to_string(robots) + (closed ? "ring" : "chain"), scene,
                 "<phase nodes='" + std::to_string(nodes) + "' contacts='left right hold'>" + costs +
                     "</phase><terminal><cost name='state' type='state' robot='ring' weight='10'/></terminal>"
                     "<solver tolerance='1e-13'/>");
}

// Returns two humanoids and a beam, in four couplings.
TaskFile beam(int nodes) {
  TaskFile task = read_task(kModels + "tasks/two_humanoids_lift_beam.xml");
  task.phases.resize(1);
  task.phases[0].nodes = nodes;
  for (TaskTerm& term : task.phases[0].costs)
    if (term.name == "beam") term.placement.p.z() -= 0.09;
  task.tolerance = 1e-13;
  return task;
}

TEST(JoinedDirections, OfARing) {
  expect_dense_direction(humanoids(4, true, 4), "Schur complement of couplings", 0.05);
}
TEST(JoinedDirections, OfABeamCarriedByTwo) { expect_dense_direction(beam(4), "Schur complement of couplings", 0.05); }

// ---- motions ----------------------------------------------------------------------------------------------------

void expect_dense_optimum(const TaskFile& task, std::size_t blocks) {
  TaskProblem whole = make_problem(task, TaskSolver::kFddp), joined = make_problem(task, TaskSolver::kSparse);
  ASSERT_EQ(joined.blocks.size(), blocks);
  for (std::size_t t = 0; t < whole.us.size(); ++t) EXPECT_LT(difference_of(joined.us[t], whole.us[t]), 1e-9);
  const TaskSolution dense = optimize(task, whole, {TaskSolver::kFddp, 1, {}});
  const TaskSolution ours = optimize(task, joined, {TaskSolver::kSparse, 1, {}});
  ASSERT_TRUE(dense.converged) << dense.reason;
  ASSERT_TRUE(ours.converged) << ours.reason;
  EXPECT_GE(ours.iterations.size(), 3u);
  EXPECT_NEAR(ours.cost, dense.cost, 1e-10 * dense.cost);
  EXPECT_LT(ours.kkt_residual, 1e-6);
  for (std::size_t t = 0; t < dense.xs.size(); ++t) EXPECT_LT(difference_of(ours.xs[t], dense.xs[t]), 1e-5) << t;
  for (std::size_t t = 0; t < dense.us.size(); ++t) EXPECT_LT(error_of(ours.us[t], dense.us[t]), 1e-5) << t;
  const std::size_t last = dense.us.size() - 1;
  const std::vector<Eigen::VectorXd> f = contact_forces(task, joined, last),
                                     expected = contact_forces(task, whole, last);
  for (std::size_t c = 0; c < f.size(); ++c) {
    ASSERT_EQ(f[c].size(), expected[c].size()) << c;
    if (f[c].size() == 0) continue;
    EXPECT_LT(difference_of(f[c], expected[c]), 1e-2) << c;
  }
}

TEST(JoinedTask, OptimumOfAChainThatForms) { expect_dense_optimum(chain(3), 3); }
TEST(JoinedTask, OptimumOfARing) { expect_dense_optimum(humanoids(3, true, 6), 3); }
TEST(JoinedTask, OptimumOfABeamCarriedByTwo) { expect_dense_optimum(beam(8), 3); }

// A force is exact in x and bounded below in z, where it binds; each robot's constraints involve the couplings too.
// Constraints are met to 1e-9, the KKT residual to 1e-6.
TEST(JoinedTask, OptimumWithConstraints) {
  TaskFile task = chain(3, "local", "0", "6d", kPush);
  task.iterations = 200;
  TaskProblem whole = make_problem(task, TaskSolver::kFddp), joined = make_problem(task, TaskSolver::kSparse);
  ASSERT_EQ(joined.blocks.size(), 3u);
  const TaskSolution dense = optimize(task, whole, {TaskSolver::kFddp, 1, {}});
  const TaskSolution ours = optimize(task, joined, {TaskSolver::kSparse, 1, {}});
  EXPECT_TRUE(dense.converged) << dense.reason;
  EXPECT_TRUE(ours.converged) << ours.reason;
  EXPECT_LE(ours.constraint_violation, 1e-9);
  EXPECT_LT(ours.kkt_residual, 1e-6);
  EXPECT_NEAR(ours.cost, dense.cost, 1e-6 * dense.cost);
  for (std::size_t t = 0; t < dense.xs.size(); ++t) EXPECT_LT(difference_of(ours.xs[t], dense.xs[t]), 1e-5) << t;
  const std::vector<Eigen::VectorXd> f = contact_forces(task, joined, 5), expected = contact_forces(task, whole, 5);
  double least = 1000;
  for (std::size_t c = 0; c < f.size(); ++c) {
    ASSERT_EQ(f[c].size(), expected[c].size()) << c;
    if (f[c].size() > 0) {
      EXPECT_LT(difference_of(f[c], expected[c]), 1e-2) << c;
    }
    if (task.scene.scene.contacts[c].name.rfind("RF", 0) == 0) {
      EXPECT_NEAR(f[c][0], 3, 1e-8);
      least = std::min(least, f[c][2]);
    }
  }
  EXPECT_NEAR(least, 40, 1e-8);
  ASSERT_EQ(ours.violations.size(), 3u);
  for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(ours.violations[k].constraint, dense.violations[k].constraint);
}

// Each robot's feedback alone, which takes the wrenches on it as given, stabilises all of them.
TEST(JoinedTask, GainsOfBlocksHoldTheMotionInSimulation) {
  const TaskFile task = beam(25);
  TaskProblem problem = make_problem(task, TaskSolver::kSparse);
  TaskSolution s = optimize(task, problem, {TaskSolver::kSparse, 1, {}});
  ASSERT_TRUE(s.converged) << s.reason;
  for (std::size_t t = 0; t < s.us.size(); ++t) {
    std::vector<int> count(static_cast<std::size_t>(s.us[t].size()));
    for (const TaskGains& own : s.gains) {
      if (own.K[t].rows() == 0) continue;
      EXPECT_EQ(own.K[t].rows(), static_cast<Eigen::Index>(own.u.size()));
      EXPECT_EQ(own.K[t].cols(), static_cast<Eigen::Index>(own.dx.size()));
      for (const int i : own.u) ++count[static_cast<std::size_t>(i)];
    }
    for (const int k : count) EXPECT_EQ(k, 1) << t;
  }
  const SimulatedMotion held = simulate(task, s, Integrator::kRk4, 5);
  s.gains.clear();
  const SimulatedMotion alone = simulate(task, s, Integrator::kRk4, 5);
  EXPECT_EQ(held.stopped, StepStatus::kOk);
  EXPECT_GT(alone.distance, 3 * held.distance);
}

TEST(JoinedTask, AutoTakesBlocksWhereTheyCostLess) {
  const TaskFile task = humanoids(6, false, 3);
  TaskProblem problem = make_problem(task, TaskSolver::kAuto);
  EXPECT_EQ(problem.blocks.size(), 6u);
  const TaskSolution solution = optimize(task, problem, {TaskSolver::kAuto, 1, {}});
  EXPECT_EQ(solution.solver, "sparse");
  EXPECT_EQ(solution.direction, "Schur complement of couplings");
  EXPECT_EQ(solution.blocks.size(), 6u);
  const TaskFile carried = beam(60);
  EXPECT_FALSE(blocks_are_cheaper(carried, divide_robots(carried)));
}

TEST(JoinedTask, RobotsThatCouplingsCannotJoinAreOneBlock) {
  using Blocks = std::vector<std::vector<int>>;
  const auto of = [](const std::string& name, const std::string& scene, const std::string& costs,
                     const std::string& integrator = "euler") {
    return divide_robots(task_of(
        name, scene, "<phase nodes='2' contacts='RF LH RH hold'>" + costs + "</phase>" + kTerminal, integrator));
  };
  EXPECT_EQ(of("couplings", chain_scene(3), kCosts), (Blocks{{0}, {1}, {2}}));
  EXPECT_EQ(of("rk4", chain_scene(2), kCosts, "rk4"), (Blocks{{0, 1}}));
  EXPECT_EQ(of("force", chain_scene(3), "<cost name='f' type='contact_force' contact='hold0'/>"),
            (Blocks{{0, 1}, {2}}));
  EXPECT_EQ(of("com_of_all", chain_scene(2), "<cost name='c' type='com' reference='0 0 0.3'/>"), (Blocks{{0, 1}}));
  EXPECT_EQ(of("torques", chain_scene(2), "<cost name='c' type='contact_control_grav'/>"), (Blocks{{0, 1}}));
}

// Two trunks are attached to each other twice.
TEST(JoinedTask, DependentCouplingsTakeNodesOfTheWholeScene) {
  std::string scene = chain_scene(2);
  scene.insert(scene.find("</scene>"),
               "<contact name='once' type='6d' frame='q0/trunk' to='q1/trunk'/>"
               "<contact name='again' type='6d' frame='q0/trunk' to='q1/trunk'/>");
  const TaskFile task =
      task_of("twice", scene, "<phase nodes='2' contacts='RF LH RH once again'>" + kCosts + "</phase>" + kTerminal);
  const std::vector<std::vector<int>> blocks = divide_robots(task);
  EXPECT_EQ(blocks.size(), 2u);
  EXPECT_FALSE(couplings_are_independent(task, blocks));
  EXPECT_EQ(make_problem(task, TaskSolver::kSparse).blocks.size(), 1u);
}

// ---- feed-forward terms, multipliers, limits ------------------------------------------------------------------------

struct Open : SolverSparse {
  using SolverSparse::computeFeedForwardGradient;
  using SolverSparse::preconditionFeedForward;
  using SolverSparse::setFeedForward;
  using SolverSparse::SolverSparse;
};

double sum_of_products(const std::vector<Eigen::VectorXd>& a, const std::vector<Eigen::VectorXd>& b) {
  double sum = 0;
  for (std::size_t t = 0; t < a.size(); ++t) sum += a[t].dot(b[t]);
  return sum;
}

// Returns a rollout of the guess with random changes.
Candidate shaken(ShootingProblem& problem, const std::vector<Eigen::VectorXd>& guess) {
  std::mt19937 rng(9);
  Candidate out{{}, guess};
  for (Eigen::VectorXd& u : out.us) u += random_vector(static_cast<int>(u.size()), rng, 3);
  out.xs = problem.rollout_us(out.us);
  return out;
}

// Directions use the Schur complement and islands. Differences with step h are accurate to h^2 and eps cost / h.
TEST(JoinedFeedForward, GradientIsThatOfTheRolledOutCost) {
  for (const TaskFile& task : {chain(5), always(2, 5)}) {
    const TaskProblem joined = make_problem(task, TaskSolver::kSparse);
    Open solver(joined.problem);
    SCOPED_TRACE(solver.direction());
    const Candidate at = shaken(*solver.get_problem(), joined.us);
    solver.solve(at.xs, at.us, 0, true);
    solver.computeDirection(true);
    ASSERT_TRUE(solver.direction_is_sound());
    const double gain = solver.expectedReduction();
    const std::vector<Eigen::VectorXd> minus_du = solver.get_k();
    std::vector<Eigen::VectorXd> g;
    solver.forwardPass(0);
    solver.get_problem()->calcDiff(solver.get_xs(), solver.get_us());
    solver.computeFeedForwardGradient(g);
    std::mt19937 rng(4);
    constexpr double h = 1e-5;
    for (int k = 0; k < 3; ++k) {
      std::vector<Eigen::VectorXd> nu;
      for (const Eigen::VectorXd& part : g) nu.push_back(random_vector(static_cast<int>(part.size()), rng));
      const auto cost = [&](double step) {
        std::vector<Eigen::VectorXd> scaled = nu;
        for (Eigen::VectorXd& part : scaled) part *= step;
        solver.setFeedForward(scaled);
        return -solver.tryStep(1);
      };
      const double slope = (cost(h) - cost(-h)) / (2 * h);
      EXPECT_NEAR(slope, sum_of_products(g, nu), 1e-5 * std::abs(slope));
    }
    // Gauss-Newton's step gains half of g^T H^-1 g, and its du at x0, where dx is zero, is that of -H^-1 g.
    std::vector<Eigen::VectorXd> step = g;
    solver.preconditionFeedForward(step);
    EXPECT_NEAR(0.5 * sum_of_products(g, step), gain, 1e-6 * gain);
    EXPECT_LT(error_of(step[0], minus_du[0]), 1e-6);
  }
}

TEST(JoinedFeedForward, DescendsToTheOptimum) {
  const TaskFile task = chain(3);
  const TaskProblem joined = make_problem(task, TaskSolver::kSparse);
  SolverSparse newton(joined.problem);
  newton.set_th_stop(1e-16);
  EXPECT_TRUE(newton.solve(joined.xs, joined.us, 50));
  const double cost = newton.get_cost();
  const std::vector<Eigen::VectorXd> us = newton.get_us();
  SolverSparse quasi(joined.problem);
  quasi.set_th_stop(1e-16);
  quasi.solve(joined.xs, joined.us, 1);
  ASSERT_GT(quasi.get_cost(), cost * (1 + 1e-11));
  quasi.descend(50);
  EXPECT_NEAR(quasi.get_cost(), cost, 1e-12 * cost) << to_string(quasi.reason());
  for (std::size_t t = 0; t < us.size(); ++t) EXPECT_LT(error_of(quasi.get_us()[t], us[t]), 1e-5) << t;
}

// At any candidate the wrenches that joined nodes eliminate are the whole scene's. Both sums have terms of the
// residual's size, up to the condition of the couplings' equations.
TEST(JoinedKktResidual, WithMultipliersAndLimitsIsThatOfTheWholeScene) {
  const TaskFile task = chain(3, "local", "0", "6d", kPush);
  const TaskProblem whole = make_problem(task, TaskSolver::kFddp), joined = make_problem(task, TaskSolver::kSparse);
  const Candidate at = random_candidate(whole, 7);
  std::mt19937 rng(8);
  std::vector<Eigen::VectorXd> l, y;
  for (std::size_t t = 0; t < at.xs.size(); ++t) {
    const ActionModelAbstract& model = *whole.problem->model(t);
    l.push_back(random_vector(static_cast<int>(model.get_state()->get_ndx()), rng));
    const bool terminal = whole.problem->by_state_alone(t);
    y.push_back(random_vector(
        static_cast<int>(terminal ? model.get_ng_T() + model.get_nh_T() : model.get_ng() + model.get_nh()), rng, 100));
  }
  for (const bool limits : {false, true}) {
    const double without = kkt_residual(*joined.problem, at.xs, at.us, l, limits);
    const double expected = kkt_residual(*whole.problem, at.xs, at.us, l, limits, y);
    EXPECT_NEAR(kkt_residual(*joined.problem, at.xs, at.us, l, limits, y), expected, 1e-9 * expected) << limits;
    EXPECT_GT(std::abs(expected - without), 1e-3 * expected) << limits;
    const auto a = least_squares_multipliers(*joined.problem, at.xs, at.us, limits);
    const auto b = least_squares_multipliers(*whole.problem, at.xs, at.us, limits);
    for (std::size_t t = 0; t < a.size(); ++t) EXPECT_LT(error_of(a[t], b[t]), 1e-7) << limits << t;
  }
  y[4][0] = 1e6;
  EXPECT_GT(kkt_residual(*joined.problem, at.xs, at.us, l, false, y), 1e4);
  y[4].resize(1);
  EXPECT_THROW((void)kkt_residual(*joined.problem, at.xs, at.us, l, false, y), std::invalid_argument);
}

// Returns the problem's joined nodes alone, with dense matrices and tight limits.
std::shared_ptr<ShootingProblem> limited(const ShootingProblem& problem, MatrixStorage storage, double limit) {
  const ShootingPart part = separate(problem).at(0);
  ShootingProblem::Models models;
  std::map<ActionModelAbstract*, std::shared_ptr<ActionModelParts>> known;
  for (std::size_t t = 0; t <= part.problem->get_T(); ++t) {
    auto& node = known[part.problem->model(t).get()];
    if (!node) {
      const auto& coupled = dynamic_cast<const ActionModelParts&>(*part.problem->model(t));
      node = coupled.with_models(coupled.get_parts());
      node->set_u_lb(Eigen::VectorXd::Constant(static_cast<Eigen::Index>(node->get_nu()), -limit));
      node->set_u_ub(Eigen::VectorXd::Constant(static_cast<Eigen::Index>(node->get_nu()), limit));
      node->set_storage(storage);
    }
    models.push_back(node);
  }
  const std::shared_ptr<ActionModelAbstract> terminal = models.back();
  models.pop_back();
  return std::make_shared<ShootingProblem>(part.problem->get_x0(), models, terminal);
}

// One dense block with a box takes the steps of SolverBoxFDDP on the whole scene, up to rounding of condensed nodes.
TEST(JoinedTask, LimitsWithDenseMatricesTakeTheStepsOfBoxFDDP) {
  const TaskFile task = chain(2);
  const TaskProblem whole = make_problem(task, TaskSolver::kFddp), joined = make_problem(task, TaskSolver::kSparse);
  const double limit = 0.7 * whole.us[0].lpNorm<Eigen::Infinity>();  // relative to the torques of rest at x0
  for (const auto& model : whole.problem->get_runningModels()) {
    model->set_u_lb(Eigen::VectorXd::Constant(static_cast<Eigen::Index>(model->get_nu()), -limit));
    model->set_u_ub(Eigen::VectorXd::Constant(static_cast<Eigen::Index>(model->get_nu()), limit));
  }
  SolverBoxFDDP dense(whole.problem);
  SolverSparse sparse(limited(*joined.problem, MatrixStorage::kDense, limit), true);
  std::vector<double> costs[2];
  int k = 0;
  for (SolverAbstract* solver : {static_cast<SolverAbstract*>(&dense), static_cast<SolverAbstract*>(&sparse)}) {
    const auto log = std::make_shared<CallbackLogger>();
    solver->setCallbacks({log});
    solver->solve(whole.xs, whole.us, 8);
    costs[k++] = log->costs;
  }
  ASSERT_GT(costs[0].size(), 3u);
  ASSERT_EQ(costs[0].size(), costs[1].size());
  for (std::size_t i = 0; i < costs[0].size(); ++i) EXPECT_NEAR(costs[1][i], costs[0][i], 1e-8 * costs[0][i]) << i;
  int at_limit = 0;
  for (std::size_t t = 0; t < dense.get_us().size(); ++t) {
    EXPECT_LT(error_of(sparse.get_us()[t], dense.get_us()[t]), 1e-6) << t;
    at_limit += static_cast<int>((sparse.get_us()[t].array().abs() == limit).count());
  }
  EXPECT_GT(at_limit, 3);
  EXPECT_THROW(SolverSparse(limited(*joined.problem, MatrixStorage::kSparse, limit), true), std::invalid_argument);
}

TEST(JoinedTask, GivesTheSameBitsForAnyNumberOfThreads) {
  const TaskFile task = chain(3);
  std::vector<TaskSolution> solutions;
  for (const int threads : {1, 2}) {
    TaskProblem problem = make_problem(task, TaskSolver::kSparse);
    solutions.push_back(optimize(task, problem, {TaskSolver::kSparse, threads, {}}));
  }
  EXPECT_TRUE(solutions[0].xs == solutions[1].xs);
  EXPECT_TRUE(solutions[0].us == solutions[1].us);
}

TEST(JoinedTask, IterationsTakeNoMemory) {
  if (!MANYCONTACT_COUNTS_ALLOCATIONS) GTEST_SKIP() << "malloc cannot be counted here";
  TaskProblem problem = make_problem(chain(3), TaskSolver::kSparse);
  problem.problem->set_nthreads(1);
  SolverSparse solver(problem.problem);
  solver.solve(problem.xs, problem.us, 3);
  EXPECT_EQ(allocations([&] { solver.solve(problem.xs, problem.us, 3); }), 0u);
}

}  // namespace
}  // namespace manycontact::test
