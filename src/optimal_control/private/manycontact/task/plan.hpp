#pragma once
// Checks of a task after the solve: places where contacts close, exceeded limits, missed goals, shares of the costs.

#include "manycontact/analysis/findings.hpp"
#include "manycontact/task/optimize.hpp"

namespace manycontact {

/// A contact that closes between two phases, with its error at the first node of the second phase, before the impact.
struct PlanClosing {
  int contact = 0;
  std::size_t node = 0;
  double time = 0;   // s
  double above = 0;  // height [m] of A's origin above its reference in the world, or distance if this is on a robot
  double aside = 0;  // horizontal distance [m] of A's origin from its reference
  double speed = 0;  // speed [m/s] of A's origin relative to B'
  bool holds_there = true;  // A stays where it closes, not at the placement in the scene (TaskPhase::at_scene)
};
/// Returns the closings of contacts by time. `aside` is nonzero for steps forward, `above` for contacts in the air.
std::vector<PlanClosing> closings(const TaskFile& task, const std::vector<Eigen::VectorXd>& xs);

struct PlanLimit {  // A coordinate beyond a limit of the robot's file, at the node where it is furthest beyond.
  LimitPassed limit;
  std::size_t node = 0;
};
/// Returns exceeded limits of position, velocity and effort, each with the coordinate's value furthest beyond.
std::vector<PlanLimit> limits_passed(const TaskFile& task, const std::vector<Eigen::VectorXd>& xs,
                                     const std::vector<Eigen::VectorXd>& us);

struct PlanCost {  // A <cost> of the task, summed over all phases and all copies of robots.
  std::string name;
  TaskResidual residual = TaskResidual::kState;
  double cost = 0;       // sum over all nodes, with the solver's weights
  bool is_goal = false;  // whether the residual is frame_placement, _translation, _rotation or com
  double missed = 0;     // |r| [m, rad] of a goal, for the worst copy at the last node with the cost
  std::size_t node = 0;
};
/// Returns the costs at the problem's last calc, largest first. Their sum is the total cost.
std::vector<PlanCost> cost_by_term(const TaskFile& task, const TaskProblem& problem);

/// A deficiency of the motion, as a line of text. `kind` is the kind of a TaskFailure, "closes" (out of place by at
/// least a millimetre), "position", "velocity", "effort", "goal" (missed by at least a millimetre or milliradian), or
/// "near_dependent" (analysis/near_dependent.hpp). `name` is that of the contact, joint, cost, or rows.
struct PlanFinding {
  std::string kind, name, text;
  std::size_t node = 0;
};
/// Returns findings about the motion of the solution. costs: the result of cost_by_term.
std::vector<PlanFinding> plan_findings(const TaskFile& task, const TaskSolution& solution,
                                       const std::vector<PlanCost>& costs);

/// Returns findings of kind "guess" at the first node of each phase: robots that the quasi-static torques of the guess
/// do not keep at rest. The list is empty if the guess is zero.
std::vector<PlanFinding> guess_findings(const TaskFile& task);

}  // namespace manycontact
