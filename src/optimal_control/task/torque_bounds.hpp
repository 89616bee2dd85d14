#pragma once

#include "manycontact/task/problem.hpp"

namespace manycontact::task {

struct TorqueBounds {  // Bounds of the torques in a phase: nu numbers of the scene, infinite for unbounded torques.
  Eigen::VectorXd lower, upper;
};

/// Returns whether all constraints bound `control` or `joint_effort`, and can be satisfied. Sets `bounds` per phase.
bool bounds_torques_alone(const TaskFile& task, std::vector<TorqueBounds>& bounds);

TaskFile without_constraints(TaskFile task);

/// Makes the bounds the control limits of the problem's nodes and their parts. With solver box-fddp, the robots' effort
/// limits also remain. Moves the problem's guess within the limits.
void limit_torques(const TaskFile& task, const std::vector<TorqueBounds>& bounds, TaskProblem& problem);

}  // namespace manycontact::task
