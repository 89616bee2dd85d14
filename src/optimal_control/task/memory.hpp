#pragma once

#include "manycontact/task/problem.hpp"

namespace manycontact::task {

/// Throws InputError if the data of nodes and solver would exceed the available memory, measured on one node per kind.
void require_memory(const TaskFile& task, const ShootingProblem::Models& running);

/// Returns whether dense Riccati recursions of the task's parts fit into half the available memory, estimated roughly.
bool dense_parts_fit(const TaskFile& task);

}  // namespace manycontact::task
