#include "manycontact/task/optimize.hpp"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <map>
#include <random>
#include <sstream>

#include "manycontact/control/augmented_lagrangian.hpp"
#include "manycontact/control/box_solvers.hpp"
#include "manycontact/control/direction.hpp"
#include "manycontact/control/fit.hpp"
#include "manycontact/detail/control/sparse.hpp"
#include "manycontact/detail/control/timer.hpp"
#include "memory.hpp"
#include "torque_bounds.hpp"

namespace manycontact {

namespace {

using Vectors = std::vector<Eigen::VectorXd>;

constexpr double kMostViolation = 1e-9, kMostResidual = 1e-6;  // largest values of a task that counts as converged

double median(std::vector<double> x) {
  if (x.empty()) return 0;
  std::nth_element(x.begin(), x.begin() + static_cast<std::ptrdiff_t>(x.size() / 2), x.end());
  return x[x.size() / 2];
}

// Times of passes over all nodes [us], and failures of the dynamics in steps along the last search direction.
struct Passes {
  std::vector<double> forward, derivatives, backward;
  const TaskProblem& problem;
  std::vector<TaskFailure> failures = {};
};

// A solver that records the times of its passes.
template <class Base>
class Timed : public Base {
 public:
  template <class... More>
  Timed(std::shared_ptr<ShootingProblem> problem, Passes& passes, More... more)
      : Base(std::move(problem), more...), passes_(passes) {}

  double calcDiff() override {
    const Timer timer;
    const double cost = Base::calcDiff();
    if (this->iter_ > 0) passes_.derivatives.push_back(timer.get_us_duration());  // the first call includes calc
    return cost;
  }
  void backwardPass() override {
    const Timer timer;
    passes_.failures.clear();
    Base::backwardPass();
    passes_.backward.push_back(timer.get_us_duration());
  }
  void forwardPass(double steplength) override {
    const Timer timer;
    Base::forwardPass(steplength);
    passes_.forward.push_back(timer.get_us_duration());
    if (std::isnan(this->cost_try_)) passes_.failures = failed_dynamics(passes_.problem);
  }

 private:
  Passes& passes_;
};

// Records each iteration, and interrupts the solve if TaskOptions::each returns false.
class Record : public CallbackAbstract {
 public:
  Record(const TaskOptions& options, std::vector<TaskIteration>& iterations)
      : options_(options), iterations_(iterations) {}

  void operator()(SolverAbstract& solver) override {
    iterations_.push_back({solver.get_cost(), solver.get_stop(), solver.get_preg(), solver.get_steplength(),
                           solver.get_ffeas(), solver.get_is_feasible()});
    if (options_.each && !options_.each(iterations_.back())) solver.interrupt();
  }

 private:
  const TaskOptions& options_;
  std::vector<TaskIteration>& iterations_;
};

// Replaces kAuto by the solver to use: sparse if make_problem has divided the problem into blocks, otherwise FDDP.
TaskSolver chosen(TaskSolver solver, std::size_t blocks) {
  if (solver != TaskSolver::kAuto) return solver;
  return blocks > 1 ? TaskSolver::kSparse : TaskSolver::kFddp;
}

std::shared_ptr<SolverDDP> make_solver(TaskSolver solver, bool by_parts,
                                       const std::shared_ptr<ShootingProblem>& problem, Passes& passes) {
  const bool limits = solver == TaskSolver::kBoxFddp;
  if (by_parts || solver == TaskSolver::kSparse) return std::make_shared<Timed<SolverSparse>>(problem, passes, limits);
  if (limits) return std::make_shared<Timed<SolverBoxFDDP>>(problem, passes);
  return std::make_shared<Timed<SolverFDDP>>(problem, passes);
}

// Returns the gains of each cluster (lq/plan.hpp) of the subproblems. Clusters may differ from node to node.
std::vector<TaskGains> gains_of(const SolverDDP& solver) {
  std::vector<TaskGains> out;
  const std::size_t T = solver.get_problem()->get_T();
  for (const auto& direction : solver.directions()) {
    std::map<std::vector<int>, std::size_t> known;  // index in `out` of the gains with these dx coordinates
    for (std::size_t t = 0; t < T; ++t)
      for (Direction::Gains& own : direction->gains(t)) {
        const auto [at, is_new] = known.emplace(own.dx, out.size());
        if (is_new) out.push_back({own.dx, {}, std::vector<Eigen::MatrixXd>(T)});
        TaskGains& gains = out[at->second];
        // Impacts have no controls, so that u is taken from another node.
        if (gains.u.empty()) gains.u = std::move(own.u);
        gains.K[t] = std::move(own.K);
      }
  }
  return out;
}

// Returns the reason with the largest violations, e.g. "infeasible constraints: there, by 4.03 at node 40".
std::string with_violations(StopReason reason, std::vector<TaskViolation> violations) {
  std::sort(violations.begin(), violations.end(), [](const auto& a, const auto& b) { return a.by > b.by; });
  std::ostringstream text;
  text << to_string(reason) << std::setprecision(3);
  constexpr std::size_t kMost = 3;
  const char* before = reason == StopReason::kInfeasible ? ": " : "; violated constraints: ";
  for (std::size_t k = 0; k < std::min(kMost, violations.size()) && violations[k].by > kMostViolation; ++k) {
    text << before << violations[k].constraint << ", by " << violations[k].by << " at node " << violations[k].node;
    before = "; ";
  }
  return text.str();
}

TaskTimes times_of(const Passes& passes, std::size_t nodes) {
  const double n = static_cast<double>(nodes);
  return {median(passes.forward) / n, median(passes.derivatives) / n, median(passes.backward) / n, 0};
}

struct Run {  // one solve, with its task, problem, settings and result
  const TaskFile& task;
  TaskProblem& problem;
  const TaskOptions& options;
  TaskSolver type;
  TaskSolution out = {};
  std::size_t most = static_cast<std::size_t>(task.iterations);
  Passes passes = {{}, {}, {}, problem};

  std::shared_ptr<SolverDDP> make(const std::shared_ptr<ShootingProblem>& shooting) {
    return make_solver(type, problem.parts.size() > 1, shooting, passes);
  }
  std::size_t left() const { return most - std::min(most, out.iterations.size()); }  // remaining iterations

  void solve(SolverAbstract& solver, const SolverDDP& inner) {
    solver.set_th_stop(task.tolerance);
    solver.setCallbacks({std::make_shared<Record>(options, out.iterations)});
    const Timer timer;
    out.converged = solver.solve(problem.xs, problem.us, left(), false);
    out.times = times_of(passes, problem.problem->get_T());
    out.times.total = timer.get_us_duration();
    out.reason = to_string(solver.reason());
    out.interrupted = solver.reason() == StopReason::kInterrupted;
    out.xs = solver.get_xs();
    out.us = solver.get_us();
    out.cost = solver.get_cost();
    out.gains = gains_of(inner);
    if (const auto* sparse = dynamic_cast<const SolverSparse*>(&inner)) {
      out.blocks = sparse->blocks();
      out.direction = sparse->direction();
    }
    if (inner.has_rolled_out())
      out.remarks.push_back(
          "no step closed the gaps: the solver continued from the motion that the torques of the guess cause within "
          "the limits");
  }

  void with_constraints() {
    SolverAugmentedLagrangian solver(problem.problem, [this](const auto& shooting) { return make(shooting); });
    solver.set_penalty_init(task.step);  // penalty like a running cost of weight 1, which is multiplied by the step
    solver.set_th_constraint(kMostViolation);
    solver.set_th_kkt(kMostResidual);
    solver.set_measures_scale(true);
    if (!problem.multipliers.empty()) solver.set_multipliers(problem.multipliers);
    solve(solver, *solver.get_inner());
    out.constraint_violation = solver.get_violation();
    out.outer_iterations = solver.get_outer_iter();
    out.multipliers = solver.get_multipliers();
    problem.problem->calc(out.xs, out.us);  // also computes the forces of couplings
    out.violations = violations(problem);
    if (!out.converged) out.reason = with_violations(solver.reason(), out.violations);
    out.kkt_residual = solver.get_kkt_residual();
  }

  void without() {
    const std::shared_ptr<SolverDDP> solver = make(problem.problem);
    solver->set_th_kkt(kMostResidual);
    solver->set_measures_scale(true);
    solve(*solver, *solver);
    out.polishing_iterations = solver->get_polishing_iter();
    out.kkt_residual = solver->get_kkt_residual();
    if (std::isfinite(out.kkt_residual)) return;
    const bool limits = solver->keeps_limits();
    const auto l = least_squares_multipliers(*problem.problem, out.xs, out.us, limits);
    out.kkt_residual = kkt_residual(*problem.problem, out.xs, out.us, l, limits, {}, solver->get_kkt_scale());
  }

  void operator()() {
    problem.problem->set_nthreads(options.threads);
    has_constraints(task) ? with_constraints() : without();
  }
};

// Solves again from the current solution. Iterations and times are added to those of the earlier solve.
void go_on(Run& run) {
  const TaskSolution before = std::move(run.out);
  const TaskProblem guess{{}, {}, {}, {}, run.problem.xs, run.problem.us, {}, {}, run.problem.multipliers};
  run.problem.xs = before.xs;
  run.problem.us = before.us;
  run.problem.multipliers = before.multipliers;
  run.out = TaskSolution();
  run.out.solver = before.solver;
  run.out.direction = "Riccati";
  run.out.blocks = before.blocks;
  run.out.iterations = before.iterations;
  run.out.remarks = before.remarks;
  run();
  run.out.times.total += before.times.total;
  run.out.outer_iterations += before.outer_iterations;
  run.problem.xs = guess.xs;
  run.problem.us = guess.us;
  run.problem.multipliers = guess.multipliers;
}

// Returns whether the solve ended at its guess, where the cost is not zero but its gradient is.
bool stayed_at_guess(const TaskSolution& s) {
  if (!s.converged || s.iterations.empty() || s.cost <= 0) return false;
  return s.iterations.front().stop <= 1e-14 * s.cost && std::abs(s.iterations.front().cost - s.cost) <= 1e-12 * s.cost;
}

// Returns whether the cost decreases near the controls us, at which its gradient vanishes. Simulates a few small random
// changes of us, with `limits` within the control limits. Sets us to the best controls, and xs to their states.
bool falls_beside(ShootingProblem& problem, bool limits, double cost, Vectors& xs, Vectors& us) {
  constexpr int kTries = 4;
  constexpr double kChange = 1e-2;  // relative to the largest control, or to 1 if that is larger
  constexpr double kFall = 1e-10;   // least decrease, relative to the cost; above its rounding error
  std::mt19937 random(1);
  std::normal_distribution<double> change(0, kChange * internal::largest_number(us));
  const Vectors centre = us;
  double least = cost - kFall * std::abs(cost);
  bool found = false;
  for (int k = 0; k < kTries; ++k) {
    Vectors tried = centre, motion(xs.size());
    for (std::size_t t = 0; t < tried.size(); ++t) {
      for (double& number : tried[t]) number += change(random);
      if (limits) internal::keep_limits(*problem.model(t), tried[t]);
    }
    problem.rollout(tried, motion);
    const double own = problem.total_cost();
    if (!(own < least)) continue;
    least = own;
    found = true;
    us = tried;
    xs = motion;
  }
  return found;
}

void leave_stationary_guess(Run& run) {
  const bool limits = run.type == TaskSolver::kBoxFddp;
  Vectors xs = run.out.xs, us = run.out.us;
  if (!falls_beside(*run.problem.problem, limits, run.out.cost, xs, us)) {
    run.problem.problem->calc(run.out.xs, run.out.us);
    return;
  }
  const TaskSolution stayed = run.out;
  run.out.xs = std::move(xs);
  run.out.us = std::move(us);
  run.out.remarks.push_back("the guess was stationary, but no minimum: the solver started from a nearby point");
  go_on(run);
}

// Solves again with Box-FDDP. Constraints that only bound torques become control limits, which every step satisfies.
void take_limits(Run& run, const std::vector<task::TorqueBounds>& bounds) {
  const TaskFile free = task::without_constraints(run.task);
  TaskProblem limited = make_problem(free, TaskSolver::kBoxFddp);
  limited.us = run.problem.us;
  task::limit_torques(free, bounds, limited);
  limited.problem->set_nthreads(run.options.threads);
  limited.xs = limited.problem->rollout_us(limited.us);
  Run box{free, limited, run.options, TaskSolver::kBoxFddp};
  box.out.solver = to_string(box.type);
  box.out.direction = "Riccati";
  box.out.blocks = run.out.blocks;
  box.out.iterations = run.out.iterations;
  box.out.remarks = run.out.remarks;
  box.out.remarks.push_back("the constraints only bound torques: box-fddp treated these bounds as limits");
  box();
  run.problem.problem->calc(box.out.xs, box.out.us);
  box.out.violations = violations(run.problem);
  for (const TaskViolation& v : box.out.violations)
    box.out.constraint_violation = std::max(box.out.constraint_violation, v.by);
  const bool worse =
      !box.out.converged && run.out.constraint_violation <= kMostViolation && box.out.cost >= run.out.cost;
  if (worse || box.out.constraint_violation > kMostViolation) {
    run.problem.problem->calc(run.out.xs, run.out.us);
    return;
  }
  box.out.outer_iterations = run.out.outer_iterations;
  box.out.times.total += run.out.times.total;
  run.out = std::move(box.out);
}

void take_dense_recursion(Run& run) {
  TaskProblem dense = make_problem(run.task, TaskSolver::kBoxFddp);  // not divided into blocks
  dense.xs = run.problem.xs;
  dense.us = run.problem.us;
  dense.multipliers = run.problem.multipliers;
  run.problem = std::move(dense);
  run.out.remarks.push_back("block-wise search directions ended with \"" + run.out.reason +
                            "\": the solver continued with the dense recursion");
  go_on(run);
}

// Adds failures of the dynamics to the reason: those at the result, or of the last tried steps if none was accepted.
void tell_failures(Run& run) {
  TaskSolution& s = run.out;
  run.problem.problem->calc(s.xs, s.us);
  s.failures = failed_dynamics(run.problem);
  if (s.failures.empty() && s.reason.rfind("no ", 0) == 0) s.failures = run.passes.failures;
  constexpr std::size_t kMost = 3;
  for (std::size_t k = 0; k < std::min(kMost, s.failures.size()); ++k)
    s.reason += (k == 0 ? "; the dynamics fail at node " + std::to_string(s.failures[k].node) + ": " : "; ") +
                s.failures[k].name + ": " + s.failures[k].text;
}

}  // namespace

TaskSolution optimize(const TaskFile& task, TaskProblem& problem, const TaskOptions& options) {
  Run run{task, problem, options, chosen(options.solver.value_or(task.solver), problem.blocks.size())};
  run.out.solver = to_string(run.type);
  run.out.direction = "Riccati";
  run.out.blocks = {static_cast<int>(problem.actuation->get_nu())};
  std::vector<task::TorqueBounds> bounds;
  const bool limits = has_constraints(task) && task::bounds_torques_alone(task, bounds);
  const bool blocks = problem.blocks.size() > problem.parts.size() && task::dense_parts_fit(task);
  // Up to three methods share the iterations equally: the chosen solver, dense recursions, and Box-FDDP with limits.
  const std::size_t all = run.most, methods = 1 + blocks + limits;
  const std::size_t share = (all + methods - 1) / methods;
  const auto goes_on = [&run] { return !run.out.converged && !run.out.interrupted && run.left() > 0; };
  run.most = share;
  run();
  run.most = limits ? std::min(all, 2 * share) : all;
  if (blocks && goes_on() && !run.out.infeasible()) take_dense_recursion(run);
  run.most = all;
  if (limits && goes_on()) take_limits(run, bounds);
  if (!has_constraints(task) && stayed_at_guess(run.out) && run.left() > 0) leave_stationary_guess(run);
  for (const std::string& remark : run.out.remarks) run.out.reason += "; " + remark;
  if (!run.out.converged) tell_failures(run);
  return std::move(run.out);
}

}  // namespace manycontact
