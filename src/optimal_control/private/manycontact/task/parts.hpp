#pragma once
// Divides a task into parts, which are sets of robots that no contact, spring or term couples with others at any node.

#include <functional>

#include "manycontact/detail/control/parts.hpp"
#include "manycontact/io/task_file.hpp"
#include "manycontact/sparse/union_find.hpp"

namespace manycontact {

/// Joins the two robots of a contact in `sets`. Does nothing for a contact with the world.
void join_ends(const Contact& contact, sparse::UnionFind& sets);
/// Joins the given robots, or all robots of the scene if the list is empty.
void join_robots(const Scene& scene, const std::vector<int>& robots, sparse::UnionFind& sets);
/// Divides the task's robots into sets, each ascending, ordered by first robot. `join` joins robots in `sets` for each
/// phase and the terminal node. A spring also joins the robots at its ends.
using JoinRobots = std::function<void(const TaskPhase& phase, sparse::UnionFind& sets)>;
std::vector<std::vector<int>> sets_of_robots(const TaskFile& task, const JoinRobots& join);

/// Returns the robots of each subproblem in ascending order, ordered by their first robots. Two robots are joined by a
/// contact that is active in any phase. All are joined by a term on the whole scene's centre of mass or momentum.
std::vector<std::vector<int>> separate_robots(const TaskFile& task);

/// Returns the task of the given robots alone, with their contacts and terms. `robots` is a set of separate_robots, or
/// of divide_robots (task/joined.hpp). Couplings to robots outside the set are left out.
TaskFile part_of(const TaskFile& task, const std::vector<int>& robots);

/// Returns the indices of the robots' coordinates in the scene's x, dx, u, in the order of part_of. Its model is null.
ActionPart coordinates_of(const Scene& scene, const std::vector<int>& robots);

/// Returns the rows of the given robots, in their order, in a residual with one row per coordinate of the whole scene.
std::vector<int> rows_of(TaskResidual residual, const Scene& scene, const std::vector<int>& robots);

}  // namespace manycontact
