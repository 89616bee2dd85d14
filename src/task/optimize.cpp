#include "manycontact/task/optimize.hpp"

#include <algorithm>
#include <chrono>
#include <limits>

#include "manycontact/control/box_solvers.hpp"
#include "manycontact/control/fddp.hpp"
#include "manycontact/task/augmented.hpp"

namespace manycontact {

namespace {

using Clock = std::chrono::steady_clock;

double us_since(Clock::time_point start) {
  return std::chrono::duration<double, std::micro>(Clock::now() - start).count();
}

double median(std::vector<double> x) {
  if (x.empty()) return 0;
  std::nth_element(x.begin(), x.begin() + static_cast<std::ptrdiff_t>(x.size() / 2), x.end());
  return x[x.size() / 2];
}

// Times of whole passes [us].
struct Passes {
  std::vector<double> forward, derivatives, backward;
};

// A solver of the control floor that times its passes.
template <class Base>
class Timed : public Base {
 public:
  Timed(std::shared_ptr<ShootingProblem> problem, Passes& passes) : Base(std::move(problem)), passes_(passes) {}

  double calcDiff() override {
    const auto start = Clock::now();
    const double cost = Base::calcDiff();
    if (this->iter_ > 0) passes_.derivatives.push_back(us_since(start));  // the first evaluates the nodes too
    return cost;
  }
  void backwardPass() override {
    const auto start = Clock::now();
    Base::backwardPass();
    passes_.backward.push_back(us_since(start));
  }
  void forwardPass(double steplength) override {
    const auto start = Clock::now();
    Base::forwardPass(steplength);
    passes_.forward.push_back(us_since(start));
  }

 private:
  Passes& passes_;
};

// Of the last calc, without what augments it.
double cost_of(const ActionModelAbstract& model, const ActionDataAbstract& data) {
  return dynamic_cast<const ActionModelAugmented*>(&model) ? static_cast<const ActionDataAugmented&>(data).inner->cost
                                                           : data.cost;
}

double total_cost(const ShootingProblem& problem) {
  double cost = cost_of(*problem.get_terminalModel(), *problem.get_terminalData());
  for (std::size_t t = 0; t < problem.get_T(); ++t)
    cost += cost_of(*problem.get_runningModels()[t], *problem.get_runningDatas()[t]);
  return cost;
}

// Keeps what each iteration did, and ends the solve where the caller says so.
class Record : public CallbackAbstract {
 public:
  Record(const TaskOptions& options, std::vector<TaskIteration>& iterations)
      : options_(options), iterations_(iterations) {}

  void operator()(SolverAbstract& solver) override {
    const bool augmented = dynamic_cast<const ActionModelAugmented*>(solver.get_problem()->get_terminalModel().get());
    iterations_.push_back({augmented ? total_cost(*solver.get_problem()) : solver.get_cost(), solver.get_stop(),
                           solver.get_preg(), solver.get_steplength(), solver.get_ffeas(), solver.get_is_feasible()});
    if (options_.each && !options_.each(iterations_.back())) solver.interrupt();
  }

 private:
  const TaskOptions& options_;
  std::vector<TaskIteration>& iterations_;
};

bool has_constraints(const TaskFile& task) {
  return !task.terminal.constraints.empty() ||
         std::any_of(task.phases.begin(), task.phases.end(), [](const TaskPhase& p) { return !p.constraints.empty(); });
}

// What `auto` is.
TaskSolver chosen(TaskSolver solver) { return solver == TaskSolver::kAuto ? TaskSolver::kFddp : solver; }

std::shared_ptr<SolverDDP> make_solver(TaskSolver solver, const std::shared_ptr<ShootingProblem>& problem,
                                       Passes& passes) {
  if (solver == TaskSolver::kBoxFddp) return std::make_shared<Timed<SolverBoxFDDP>>(problem, passes);
  return std::make_shared<Timed<SolverFDDP>>(problem, passes);
}

// ---- constraints: rounds of the augmented Lagrangian

constexpr double kMostViolation = 5e-9, kMostPenalty = 1e8, kFirstTolerance = 1e-4;

template <class F>
void each_node(const ShootingProblem& problem, const F& f) {
  for (std::size_t t = 0; t < problem.get_T(); ++t)
    f(dynamic_cast<ActionModelAugmented&>(*problem.get_runningModels()[t]), *problem.get_runningDatas()[t]);
  f(dynamic_cast<ActionModelAugmented&>(*problem.get_terminalModel()), *problem.get_terminalData());
}

double violation(const ShootingProblem& problem) {
  double worst = 0;
  each_node(problem, [&](const ActionModelAugmented& model, const ActionDataAbstract& data) {
    worst = std::max(worst, model.violation(data));
  });
  return worst;
}

// Until the constraints hold at a minimum; returns why it ended. The penalty begins as weak as a running
// cost of weight 1 and rises where a round did not cut the violation to a quarter.
std::string solve_rounds(const TaskFile& task, const TaskProblem& guess, SolverDDP& solver, TaskSolution& out) {
  ShootingProblem& problem = *solver.get_problem();
  std::vector<Eigen::VectorXd> xs = guess.xs, us = guess.us;
  bool feasible = false;
  double before = std::numeric_limits<double>::infinity(), penalty = task.step, tolerance = kFirstTolerance;
  each_node(problem, [&](ActionModelAugmented& model, const ActionDataAbstract&) { model.set_penalty(penalty); });
  while (true) {
    tolerance = std::max(tolerance, task.tolerance);
    solver.set_th_stop(tolerance);
    const std::size_t left = static_cast<std::size_t>(task.iterations) - out.iterations.size();
    if (left == 0) return to_string(StopReason::kIterations);
    const bool minimum = solver.solve(xs, us, left, feasible);
    const StopReason reason = solver.reason();
    xs = solver.get_xs(), us = solver.get_us(), feasible = solver.get_is_feasible();
    problem.calc(xs, us);
    out.constraint_violation = violation(problem);
    out.converged = minimum && tolerance == task.tolerance && out.constraint_violation <= kMostViolation;
    tolerance *= 0.1;
    if (minimum ? out.converged : reason != StopReason::kNoStep) return to_string(reason);
    const bool slow = !(out.constraint_violation <= 0.25 * before);
    if (slow && penalty >= kMostPenalty) return "constraints not met";
    if (slow) penalty *= 10;
    before = out.constraint_violation;
    each_node(problem, [&](ActionModelAugmented& model, const ActionDataAbstract& data) {
      model.update_multipliers(data);
      model.set_penalty(penalty);
    });
  }
}

// Gradients of the value function at the candidate. (Those of a plain adjoint recursion, without the feedback, would
// grow with the unstable motions of the robots.)
std::vector<Eigen::VectorXd> multipliers_of(SolverDDP& solver) {
  solver.get_problem()->calc(solver.get_xs(), solver.get_us());
  solver.computeDirection(true);
  return solver.get_Vx();
}

TaskTimes times_of(const Passes& passes, std::size_t nodes) {
  const double n = static_cast<double>(nodes);
  return {median(passes.forward) / n, median(passes.derivatives) / n, median(passes.backward) / n, 0};
}

}  // namespace

std::string why_not(TaskSolver solver) {
  return chosen(solver) == TaskSolver::kSparse ? "solver sparse is not built yet, expected fddp, box-fddp or auto" : "";
}

TaskSolution optimize(const TaskFile& task, TaskProblem& problem, const TaskOptions& options) {
  const std::string why = why_not(options.solver);
  if (!why.empty()) throw InputError(task.path, task.solver_line, why);
  const TaskSolver type = chosen(options.solver);
  const bool constrained = has_constraints(task);
  const std::shared_ptr<ShootingProblem> shooting = constrained ? augmented(*problem.problem) : problem.problem;
  shooting->set_nthreads(options.threads);
  Passes passes;
  TaskSolution out;
  const std::shared_ptr<SolverDDP> solver = make_solver(type, shooting, passes);
  solver->set_th_stop(task.tolerance);
  solver->setCallbacks({std::make_shared<Record>(options, out.iterations)});

  const auto start = Clock::now();
  if (constrained) {
    out.reason = solve_rounds(task, problem, *solver, out);
  } else {
    out.converged = solver->solve(problem.xs, problem.us, static_cast<std::size_t>(task.iterations), false);
    out.reason = to_string(solver->reason());
  }
  const double total = us_since(start);
  out.times = times_of(passes, shooting->get_T());
  out.times.total = total;
  out.xs = solver->get_xs();
  out.us = solver->get_us();
  out.solver = to_string(type);
  out.blocks = {static_cast<int>(problem.actuation->get_nu())};
  const bool limits = type == TaskSolver::kBoxFddp;
  out.kkt_residual =
      std::max(kkt_residual(*shooting, out.xs, out.us, multipliers_of(*solver), limits), out.constraint_violation);
  out.cost = problem.problem->calc(out.xs, out.us);
  return out;
}

}  // namespace manycontact
