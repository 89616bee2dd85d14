#pragma once

#include "manycontact/task/problem.hpp"

namespace manycontact::task {

/// Throws InputError if the data of the horizon's nodes and of the solver would exceed the memory. One node of each
/// kind is created to measure its size.
void require_memory(const TaskFile& task, const ShootingProblem::Models& running);

/// Whether the dense Riccati recursions of the task's parts fit into memory, estimated roughly.
bool dense_parts_fit(const TaskFile& task);

}  // namespace manycontact::task
