#pragma once
// How far a motion is from its constraints.

#include "manycontact/task/problem.hpp"

namespace manycontact {

struct TaskViolation {  // How far a constraint is from being met.
  std::string constraint;
  double by = 0;         // largest distance of a row to its bounds, over all nodes
  std::size_t node = 0;  // where
};

/// Of every constraint, by name, at the problem's last calc.
std::vector<TaskViolation> violations(const TaskProblem& problem);

}  // namespace manycontact
