#pragma once
// Checks that solvers do not make: where contacts close, exceeded limits, missed goals, and the share of each cost.

#include "manycontact/analysis/findings.hpp"
#include "manycontact/task/optimize.hpp"

namespace manycontact {

/// A contact that closes between two phases, at the first node of the second, before its impact.
struct PlanClosing {
  int contact = 0;
  std::size_t node = 0;
  double time = 0;   // s
  double above = 0;  // m: signed height of A's origin above its place (world z); between bodies: their distance
  double aside = 0;  // m: distance across the normal
  double speed = 0;  // m/s: speed of A's origin relative to B'
  bool holds_there = true;  // fixed where it closes, not where the scene has it (TaskPhase::at_scene)
};
/// Returns the closings in the order of time. `aside` is normal for a step forward; `above` means contact in the air.
std::vector<PlanClosing> closings(const TaskFile& task, const std::vector<Eigen::VectorXd>& xs);

struct PlanLimit {  // A coordinate beyond a limit of the robot's file, where it is furthest.
  LimitPassed limit;
  std::size_t node = 0;
};
/// Returns the worst value of every coordinate and quantity, by robot: position, velocity, and effort.
std::vector<PlanLimit> limits_passed(const TaskFile& task, const std::vector<Eigen::VectorXd>& xs,
                                     const std::vector<Eigen::VectorXd>& us);

struct PlanCost {  // A <cost> of the task: one name in all phases, all copies together.
  std::string name;
  TaskResidual residual = TaskResidual::kState;
  double cost = 0;       // sum over all nodes, with the solver's weights
  bool is_goal = false;  // the residual is a place or an orientation: frame_placement, _translation, _rotation, com
  double missed = 0;     // goals only: |r| of the worst copy at the last node that has the cost [m, rad]
  std::size_t node = 0;
};
/// The costs at the problem's last calc, largest first. They add up to the total cost.
std::vector<PlanCost> cost_by_term(const TaskFile& task, const TaskProblem& problem);

/// One line for each part of the plan that deserves attention. `kind` is that of a failure, "closes" (out of place by a
/// millimetre or more), "position", "velocity", "effort", "goal" (missed by a millimetre or milliradian, or more), or
/// "near_dependent" (analysis/near_dependent.hpp). `name` is that of the contact, joint, cost, or rows.
struct PlanFinding {
  std::string kind, name, text;
  std::size_t node = 0;
};
/// Checks the motion of the solution; `costs` is the result of cost_by_term.
std::vector<PlanFinding> plan_findings(const TaskFile& task, const TaskSolution& solution,
                                       const std::vector<PlanCost>& costs);

/// Lists robots that the quasi-static torques of the guess do not keep at rest, phase by phase: findings of kind
/// "guess", at the first node of the phase. None if the guess is zero.
std::vector<PlanFinding> guess_findings(const TaskFile& task);

}  // namespace manycontact
