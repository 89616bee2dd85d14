#pragma once

#include "manycontact/task/problem.hpp"

namespace manycontact::task {

/// Throws InputError where the data of the horizon's nodes and what solvers keep with them would not fit into the
/// memory that there is. One node of each kind is made to see what it takes.
void require_memory(const TaskFile& task, const ShootingProblem::Models& running);

/// Whether the dense recursion of the task's parts would fit, roughly.
bool dense_parts_fit(const TaskFile& task);

}  // namespace manycontact::task
