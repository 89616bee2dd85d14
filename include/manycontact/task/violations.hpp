#pragma once
// The violation of a motion's constraints.

#include "manycontact/task/problem.hpp"

namespace manycontact {

struct TaskViolation {  // The violation of one constraint.
  std::string constraint;
  double by = 0;         // largest distance of a row from its bounds, over all nodes
  std::size_t node = 0;  // the node with the largest distance
};

/// Lists the violation of every constraint, by name, at the problem's last calc.
std::vector<TaskViolation> violations(const TaskProblem& problem);

}  // namespace manycontact
