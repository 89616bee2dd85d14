#pragma once
// A coupled subproblem divided into blocks of ActionModelParts, if contacts between bodies are all that couples its
// robots; these contacts are the couplings.

#include "manycontact/io/task_file.hpp"

namespace manycontact {

/// Divides the task's robots into blocks, each ascending, in the order of their first robots. Robots are in one block
/// if one of the following couples them: a contact that cannot be a coupling (of a fixed base), a cost or constraint on
/// a contact between them, a centre of mass or momentum of the whole scene, or a residual of torques that contains the
/// couplings' forces (joint_effort, control_grav, contact_control_grav). All robots are one block if there are impacts,
/// or if the integrator is not euler.
std::vector<std::vector<int>> divide_robots(const TaskFile& task);

/// Whether the direction of these blocks takes fewer operations than that of the whole task, by structure alone.
bool blocks_are_cheaper(const TaskFile& task, const std::vector<std::vector<int>>& blocks);

/// Whether the couplings between blocks are independent at x0 in every phase. Forces of dependent couplings are not
/// unique, and nodes of the whole scene, with forces of least norm, are needed.
bool couplings_are_independent(const TaskFile& task, const std::vector<std::vector<int>>& blocks);

}  // namespace manycontact
