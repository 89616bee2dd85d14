#pragma once
// Robots of one part that hold each other, taken apart where contacts between their bodies are all that joins them:
// blocks of ActionModelParts, whose couplings these contacts are.

#include "manycontact/io/task_file.hpp"

namespace manycontact {

/// The task's robots by blocks, each ascending, in the order of their first ones. One block are robots that are joined
/// by a contact which no coupling can be (of a fixed base), by a cost or constraint on a contact between them, by a
/// centre of mass or momentum of the whole scene, or by a residual of torques with the couplings' forces in it
/// (joint_effort, control_grav, contact_control_grav). All robots are one block where there are impacts, or the
/// integrator is not euler.
std::vector<std::vector<int>> divide_robots(const TaskFile& task);

/// Whether the direction of these blocks takes fewer operations than that of the whole task, by structure alone.
bool blocks_are_cheaper(const TaskFile& task, const std::vector<std::vector<int>>& blocks);

/// Whether the couplings between blocks are independent at x0 in every phase: forces of dependent ones are no single
/// answer, and nodes of the whole scene, which take those of least norm, are needed.
bool couplings_are_independent(const TaskFile& task, const std::vector<std::vector<int>>& blocks);

}  // namespace manycontact
