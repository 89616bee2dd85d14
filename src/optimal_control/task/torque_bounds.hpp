#pragma once

#include "manycontact/task/problem.hpp"

namespace manycontact::task {

struct TorqueBounds {  // torque bounds of a phase's nodes: the scene's nu numbers, infinite where there are none
  Eigen::VectorXd lower, upper;
};

/// Whether all constraints are on `control` or `joint_effort` and can be met; then `bounds` are those of each phase.
bool bounds_torques_alone(const TaskFile& task, std::vector<TorqueBounds>& bounds);

TaskFile without_constraints(TaskFile task);

/// Makes the bounds (with solver box-fddp also the robots' efforts) the limits of the problem's nodes and of their
/// parts, and moves its guess within them.
void limit_torques(const TaskFile& task, const std::vector<TorqueBounds>& bounds, TaskProblem& problem);

}  // namespace manycontact::task
