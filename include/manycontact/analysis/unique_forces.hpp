#pragma once

#include <vector>

#include "manycontact/dynamics/data.hpp"

namespace manycontact {

/// Finds which contact forces are unique, and which are distributed arbitrarily among redundant contacts. Returns one
/// flag per row of data.f. The flag is 1 if all f with the same J^T f agree in this row. It is 0 if a vector of the
/// null space of J^T is not zero in this row, or if there is no solution. A door on two ball joints has unique
/// horizontal forces, but the distribution of its weight is not unique.
///
/// Scene::moment_length weights moments against forces in the norm, but does not influence which forces are unique. To
/// choose other forces, see analysis/redistribute_forces.hpp.
///
/// Call it after solve at q (nq). With damping every force is unique. Otherwise random vectors w are projected on the
/// null space of J^T, by solves of the scene at rest: the projection is w - J x with the least |J x - w|. Component i
/// is unique if entry i of every projection is zero. Throws std::logic_error before a solve.
std::vector<char> unique_forces(const Scene& scene, const ConstVectorRef& q, const SceneData& data);

}  // namespace manycontact
