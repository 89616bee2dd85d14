#pragma once
// Divides a coupled subproblem into blocks of ActionModelParts, if contacts between bodies are its only couplings.

#include "manycontact/io/task_file.hpp"

namespace manycontact {

/// Divides the task's robots into blocks, each ascending, ordered by first robot. These couple robots into one block: a
/// contact that cannot be a coupling (of a fixed base), a cost or constraint on a contact between them, centre of mass
/// or momentum of the whole scene, and residuals of torques with the couplings' forces (joint_effort, control_grav,
/// contact_control_grav). All robots are one block with impacts, or an integrator other than euler.
std::vector<std::vector<int>> divide_robots(const TaskFile& task);

/// Whether the direction of these blocks takes fewer operations than that of the whole task, by structure alone.
bool blocks_are_cheaper(const TaskFile& task, const std::vector<std::vector<int>>& blocks);

/// Whether the couplings between blocks are independent at x0 in every phase. Forces of dependent couplings are not
/// unique, and nodes of the whole scene, with forces of least norm, are needed.
bool couplings_are_independent(const TaskFile& task, const std::vector<std::vector<int>>& blocks);

}  // namespace manycontact
