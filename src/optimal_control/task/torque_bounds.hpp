#pragma once
// Tasks whose only constraints are bounds of the torques.

#include "manycontact/task/problem.hpp"

namespace manycontact::task {

struct TorqueBounds {  // torque bounds of a phase's nodes: the scene's nu numbers, infinite where there are none
  Eigen::VectorXd lower, upper;
};

/// Whether every constraint is one on `control` or `joint_effort`; then bounds are theirs, by phase, and with solver
/// box-fddp the robots' efforts too.
bool bounds_torques_alone(const TaskFile& task, std::vector<TorqueBounds>& bounds);

/// The task without its constraints.
TaskFile without_constraints(TaskFile task);

/// Makes the bounds the limits of the problem's nodes and of their parts, and brings its guess within them.
void limit_torques(const TaskFile& task, const std::vector<TorqueBounds>& bounds, TaskProblem& problem);

}  // namespace manycontact::task
