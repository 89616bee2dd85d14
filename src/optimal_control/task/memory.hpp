#pragma once

#include "manycontact/task/problem.hpp"

namespace manycontact::task {

/// Throws InputError if data of nodes and solver would exceed the memory, which data of one node of each kind show.
void require_memory(const TaskFile& task, const ShootingProblem::Models& running);

/// Whether the dense Riccati recursions of the task's parts fit into memory, estimated roughly.
bool dense_parts_fit(const TaskFile& task);

}  // namespace manycontact::task
