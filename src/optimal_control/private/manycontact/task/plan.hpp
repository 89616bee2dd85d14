#pragma once
// Checks of a solved task after the solve: where contacts close, exceeded limits, missed goals, the share of each cost.

#include "manycontact/analysis/findings.hpp"
#include "manycontact/task/optimize.hpp"

namespace manycontact {

/// A contact that closes between two phases: its error at the first node of the second phase, before the impact.
struct PlanClosing {
  int contact = 0;
  std::size_t node = 0;
  double time = 0;   // s
  double above = 0;  // m: signed height of A's origin above its reference (world z); between bodies: their distance
  double aside = 0;  // m: horizontal distance of A's origin from its reference
  double speed = 0;  // m/s: speed of A's origin relative to B'
  bool holds_there = true;  // the frames are fixed where they are, not at the scene's placement (TaskPhase::at_scene)
};
/// Returns the closings in the order of time. A step forward has `aside`; a nonzero `above` is a contact in the air.
std::vector<PlanClosing> closings(const TaskFile& task, const std::vector<Eigen::VectorXd>& xs);

struct PlanLimit {  // A coordinate beyond a limit of the robot's file, at the node where it is furthest beyond.
  LimitPassed limit;
  std::size_t node = 0;
};
/// Returns exceeded limits of position, velocity and effort: for each coordinate the value furthest beyond the limit.
std::vector<PlanLimit> limits_passed(const TaskFile& task, const std::vector<Eigen::VectorXd>& xs,
                                     const std::vector<Eigen::VectorXd>& us);

struct PlanCost {  // A <cost> of the task, summed over all phases and all copies of robots.
  std::string name;
  TaskResidual residual = TaskResidual::kState;
  double cost = 0;       // sum over all nodes, with the solver's weights
  bool is_goal = false;  // the residual is a place or an orientation: frame_placement, _translation, _rotation, com
  double missed = 0;     // goals only: |r| of the worst copy at the last node that has the cost [m, rad]
  std::size_t node = 0;
};
/// Returns the costs at the problem's last calc, largest first. Their sum is the total cost.
std::vector<PlanCost> cost_by_term(const TaskFile& task, const TaskProblem& problem);

/// A line about a deficiency of the motion. `kind` is the kind of a TaskFailure, "closes" (out of place by at least a
/// millimetre), "position", "velocity", "effort", "goal" (missed by at least a millimetre or milliradian), or
/// "near_dependent" (analysis/near_dependent.hpp). `name`: name of the contact, joint, cost, or rows.
struct PlanFinding {
  std::string kind, name, text;
  std::size_t node = 0;
};
/// Checks the motion of the solution; `costs` is the result of cost_by_term.
std::vector<PlanFinding> plan_findings(const TaskFile& task, const TaskSolution& solution,
                                       const std::vector<PlanCost>& costs);

/// Lists robots that the quasi-static torques of the guess do not keep at rest, for each phase, as findings of kind
/// "guess" at the first node of the phase. The list is empty if the guess is zero.
std::vector<PlanFinding> guess_findings(const TaskFile& task);

}  // namespace manycontact
