#pragma once
// Divides a task into parts: robots that neither contacts nor costs couple at any node have motions of their own.

#include <functional>

#include "manycontact/detail/control/parts.hpp"
#include "manycontact/io/task_file.hpp"
#include "manycontact/sparse/union_find.hpp"

namespace manycontact {

/// Joins the robots of both ends of a contact, if both have one.
void join_ends(const Contact& contact, sparse::UnionFind& sets);
/// Joins these robots, or all robots of the scene if the list is empty.
void join_robots(const Scene& scene, const std::vector<int>& robots, sparse::UnionFind& sets);
/// Divides the task's robots into sets, each ascending, in the order of their first ones. `join` joins robots for one
/// phase or for the terminal node; springs join their ends.
using JoinRobots = std::function<void(const TaskPhase& phase, sparse::UnionFind& sets)>;
std::vector<std::vector<int>> sets_of_robots(const TaskFile& task, const JoinRobots& join);

/// The robots of each subproblem, ascending, in the order of the first ones. Robots are joined by a contact that is
/// active in any phase; all of them by a centre of mass or a momentum of the whole scene.
std::vector<std::vector<int>> separate_robots(const TaskFile& task);

/// The task of these robots alone, with the contacts among them and the terms that are about them. The robots are whole
/// parts of separate_robots, or blocks of divide_robots (task/joined.hpp), whose couplings are left out.
TaskFile part_of(const TaskFile& task, const std::vector<int>& robots);

/// Returns the coordinates of these robots among the scene's x, dx, u, in part_of's order; without a model.
ActionPart coordinates_of(const Scene& scene, const std::vector<int>& robots);

/// Returns the rows, of a residual of the whole scene's single coordinates, that belong to these robots, in order.
std::vector<int> rows_of(TaskResidual residual, const Scene& scene, const std::vector<int>& robots);

}  // namespace manycontact
