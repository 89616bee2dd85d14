// Prints the summary of `optimize`: why it ended, motion of robots, torques, forces, times.

#include <algorithm>

#include "optimize.hpp"
#include "program/text/table.hpp"

namespace manycontact::cli {

namespace {

constexpr const char* kIntegrators[] = {"euler", "rk2", "rk3", "rk4", "symplectic"};

void print_constraints(std::ostream& out, const TaskSolution& s) {
  if (s.violations.empty()) return;
  out << "constraints are violated by " << scientific(s.constraint_violation) << " at most, after "
      << count(s.outer_iterations, "outer iteration") << "\n";
  Table table("constraints<40|missed by|at node");
  for (const TaskViolation& v : s.violations)
    table.add({printable(v.constraint), scientific(v.by), std::to_string(v.node)});
  table.print(out);
}

void print_simulation(std::ostream& out, const SimulatedMotion& s) {
  out << "in simulation" << (s.stopped == StepStatus::kOk ? "" : ", which stopped early,") << " contacts drift by "
      << scientific(s.violation_position) << " m or rad at most, the state deviates by " << number(s.distance)
      << " from the plan";
  if (s.energy_lost > 0) out << "; impacts dissipate " << number(s.energy_lost) << " J";
  out << "\n";
}

void print_times(std::ostream& out, const TaskSolution& s) {
  const TaskTimes& t = s.times;
  out << "time: " << number(t.total / 1e3) << " ms; per node and iteration " << number(t.calc) << " us forward pass, "
      << number(t.calc_diff) << " us derivatives, " << number(t.direction) << " us backward pass\n";
}

}  // namespace

void print_summary(std::ostream& out, const OptimizedTask& motion) {
  const TaskFile& task = motion.task;
  const TaskSolution& s = motion.solution;
  const Scene& scene = task.scene.scene;
  const long impacts = std::ranges::count_if(motion.nodes, &TaskNode::impact);
  out << printable(task.name) << ": " << s.solver << (s.converged ? " converged" : " did not converge") << " after "
      << count(s.iterations.size(), "iteration")
      << (s.polishing_iterations > 0 ? " and " + std::to_string(s.polishing_iterations) + " more" : "") << " ("
      << printable(s.reason) << "), cost " << number(s.cost, 6) << ", KKT residual " << scientific(s.kkt_residual)
      << "\n"
      << count(s.us.size() - impacts, "node") << " of " << number(task.step) << " s"
      << (impacts > 0 ? " and " + count(impacts, "impact") : "") << ", "
      << kIntegrators[static_cast<int>(task.integrator)] << "; " << count(scene.nrobots(), "robot") << ", nv "
      << scene.nv << ", " << count(scene.nu, "torque") << "; " << count(task.phases.size(), "phase") << ", "
      << count(scene.contacts.size(), "contact") << "\n";
  if (s.solver == to_string(TaskSolver::kSparse) || motion.problem.parts.size() > 1)
    out << "directions: " << s.direction << ", " << count(motion.problem.parts.size(), "part") << ", "
        << count(motion.problem.blocks.size(), "block") << "\n";
  if (!s.iterations.empty() && !s.iterations.back().feasible)
    out << "the states have gaps: the torques do not lead to these states\n";
  print_constraints(out, s);
  print_motion(out, motion);
  print_torques(out, motion);
  print_forces(out, motion);
  print_costs(out, motion);
  print_plan_findings(out, motion);
  if (motion.simulation) print_simulation(out, *motion.simulation);
  print_times(out, s);
}

}  // namespace manycontact::cli
