#pragma once
// Divides a coupled subproblem into blocks of ActionModelParts, if only contacts between its robots couple them.

#include "manycontact/io/task_file.hpp"

namespace manycontact {

/// Divides the task's robots into blocks, each ascending, ordered by first robot. Two robots are in one block if they
/// have a contact that cannot be a coupling (on a fixed base), or a cost or constraint on their contact. All robots of
/// a term are in one block if it concerns the whole scene's centre of mass or momentum, or torques (joint_effort,
/// control_grav, contact_control_grav). With impacts, or an integrator other than Euler, there is one block.
std::vector<std::vector<int>> divide_robots(const TaskFile& task);

/// Returns whether a direction with these blocks takes fewer operations than a dense one, predicted from sizes alone.
bool blocks_are_cheaper(const TaskFile& task, const std::vector<std::vector<int>>& blocks);

/// Returns whether the couplings between blocks are linearly independent at x0 in every phase. If not, their forces are
/// not unique, and nodes of the whole scene are needed, which have the forces of least norm.
bool couplings_are_independent(const TaskFile& task, const std::vector<std::vector<int>>& blocks);

}  // namespace manycontact
