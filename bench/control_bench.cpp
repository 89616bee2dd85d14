// Times one iteration of FDDP: derivatives of all nodes, direction, and a quarter step, since full steps of long chains
// diverge from this start and would distort the time. Also times the backward pass alone, and a control step of a
// receding horizon. Separate robots (control/separate) and a chain of robots hand in hand (control/chain) are solved by
// parts, and both on nodes of the whole scene (control/dense, control/dense_chain).

#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>

#include "manycontact/detail/control/sparse.hpp"
#include "manycontact/task/problem.hpp"
#include "scenes.hpp"
#include "settings.hpp"

namespace manycontact::bench {
namespace {

TaskTerm term(TaskResidual residual, double weight, int robots) {
  TaskTerm out;
  out.name = to_string(residual);
  out.residual = residual;
  out.weight = weight;
  for (int r = 0; r < robots; ++r) out.robots.push_back(r);
  return out;
}

// Returns a task in which robots on both feet move their centres of mass. hand_in_hand: they form a chain.
TaskFile task_of(int robots, int nodes, bool hand_in_hand) {
  const Posed posed = bench::robots(robots, hand_in_hand && robots > 1);
  TaskFile task;
  task.scene.scene = posed.scene;
  task.scene.q = posed.q;
  task.scene.v = posed.v;
  task.scene.u = posed.u;
  task.step = 0.01;
  TaskPhase phase;
  phase.nodes = nodes;
  phase.active.assign(posed.scene.contacts.size(), true);
  if (hand_in_hand && robots > 1) phase.active.back() = false;
  phase.costs = {term(TaskResidual::kState, 1, robots), term(TaskResidual::kControl, 1e-3, robots),
                 term(TaskResidual::kCom, 10, robots)};
  phase.costs[2].reference = Eigen::Vector3d(0.05, 0, 0.8);
  task.phases = {phase};
  task.terminal = phase;
  task.terminal.nodes = 0;
  task.terminal.costs.erase(task.terminal.costs.begin() + 1);
  return task;
}

// A solver after its first iteration.
template <class Solver>
struct Started {
  TaskProblem problem;
  std::unique_ptr<Solver> solver;

  Started(int robots, int nodes, bool chain, TaskSolver type)
      : problem(make_problem(task_of(robots, nodes, chain), type)) {
    problem.problem->set_nthreads(1);
    solver = std::make_unique<Solver>(problem.problem);
    solver->solve(problem.xs, problem.us, 1);
    restart();
  }
  void restart() {
    solver->setCandidate(problem.xs, problem.us, false);
    problem.problem->calc(problem.xs, problem.us);
  }
};

template <class Solver>
void iteration(benchmark::State& state, int robots, int nodes, bool chain, TaskSolver type) {
  Started<Solver> s(robots, nodes, chain, type);
  double change = 0;
  for (auto _ : state) {
    s.solver->computeDirection(true);
    benchmark::DoNotOptimize(change = s.solver->tryStep(0.25));
    state.PauseTiming();
    s.restart();
    state.ResumeTiming();
  }
  state.counters["sound"] = s.solver->direction_is_sound() && std::isfinite(change);
}

template <class Solver>
void backward(benchmark::State& state, int robots, int nodes, bool chain, TaskSolver type) {
  Started<Solver> s(robots, nodes, chain, type);
  s.solver->calcDiff();
  for (auto _ : state) s.solver->backwardPass();
  state.counters["sound"] = s.solver->direction_is_sound();
}

// Times a control step of a receding horizon, which shifts by a node and makes an iteration from the last solution.
void control_step(benchmark::State& state, int robots, int nodes) {
  Started<SolverSparse> s(robots, nodes, false, TaskSolver::kSparse);
  ShootingProblem& horizon = *s.problem.problem;
  s.solver->solve(s.problem.xs, s.problem.us, 20);
  std::vector<Eigen::VectorXd> xs = s.solver->get_xs(), us = s.solver->get_us();
  for (auto _ : state) {
    horizon.circularAppend(horizon.get_runningModels()[0], horizon.get_runningDatas()[0]);
    for (auto* guess : {&xs, &us}) {
      std::rotate(guess->begin(), guess->begin() + 1, guess->end());
      guess->back() = (*guess)[guess->size() - 2];
    }
    horizon.set_x0(xs[0]);
    s.solver->solve(xs, us, 1);
    xs = s.solver->get_xs();
    us = s.solver->get_us();
  }
  state.counters["sound"] = s.solver->direction_is_sound();
}

template <class Run>
void add(const std::string& name, Run run) {
  benchmark::RegisterBenchmark(name.c_str(), run)->Unit(benchmark::kMillisecond);
}

template <class Solver>
void add_both(const std::string& name, int robots, int nodes, bool chain, TaskSolver type) {
  add(name + "/iteration", [=](benchmark::State& s) { iteration<Solver>(s, robots, nodes, chain, type); });
  add(name + "/backward", [=](benchmark::State& s) { backward<Solver>(s, robots, nodes, chain, type); });
}

const Registration registered([] {
  for (const int robots : {1, 4, 16, 64}) {
    if (settings().quick && robots != 1 && robots != 16) continue;
    const std::string name = "control/separate/" + std::to_string(robots);
    add_both<SolverSparse>(name, robots, 50, false, TaskSolver::kSparse);
    add(name + "/control_step", [=](benchmark::State& s) { control_step(s, robots, 50); });
  }
  for (const int robots : {2, 4, 8, 16, 32}) {
    if (settings().quick && robots != 16) continue;
    add_both<SolverSparse>("control/chain/" + std::to_string(robots), robots, 50, true, TaskSolver::kSparse);
  }
  // On nodes of the whole scene, the horizon has five nodes instead of fifty and takes a tenth of the time.
  if (settings().quick) return;
  for (const int robots : {1, 4, 16})
    add_both<SolverFDDP>("control/dense_5_nodes/" + std::to_string(robots), robots, 5, false, TaskSolver::kFddp);
  for (const int robots : {2, 4, 8, 16})
    add_both<SolverFDDP>("control/dense_chain_5_nodes/" + std::to_string(robots), robots, 5, true, TaskSolver::kFddp);
});

}  // namespace
}  // namespace manycontact::bench
