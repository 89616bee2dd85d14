#pragma once
// The violation of a motion's constraints, and states whose dynamics fail.

#include "manycontact/task/problem.hpp"

namespace manycontact {

struct TaskViolation {     // The violation of one constraint.
  std::string constraint;  // name of the constraint
  double by = 0;           // largest distance of a row from its bounds, over all nodes
  std::size_t node = 0;    // the node with the largest distance
};

/// Lists the violation of every constraint, by name, at the problem's last calc.
std::vector<TaskViolation> violations(const TaskProblem& problem);

struct TaskFailure {  // A part of a scene whose dynamics could not be solved, and why.
  std::size_t node = 0;
  std::string kind, name, text;  // "no_inertia", a joint, the reason (massless_joints); or "failed", robots, the reason
};

/// Lists the failures of the first node whose dynamics failed in the problem's last calc; empty if none failed.
std::vector<TaskFailure> failed_dynamics(const TaskProblem& problem);

}  // namespace manycontact
