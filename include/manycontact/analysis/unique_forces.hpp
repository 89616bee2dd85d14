#pragma once
// Which contact forces are what they are, and which are shared at will among contacts that depend on each other.

#include <vector>

#include "manycontact/dynamics/data.hpp"

namespace manycontact {

/// Per row of data.f: 1 where every f with the same J^T f has this component, so that it is *the* force there; 0 where
/// f of least norm is a choice among many, because the null space of J^T has a part in it, and where there is no
/// answer. A door on two balls: the horizontal forces are unique, how they share the weight is not.
///
/// The norm adds squares of newtons and newton metres alike. With J's rows in other units, other forces are least;
/// those that are unique stay what they are.
///
/// After solve at q (nq). With damping every force is unique: that of the damped system. Where rows depend, by solves
/// of the scene at rest: the part of w that no motion has, w - J x with the least |J x - w|, is w's projection on the
/// null space; a component that it is nothing of for several w of mixed size has no part in it. Throws std::logic_error
/// before a solve.
std::vector<char> unique_forces(const Scene& scene, const Eigen::Ref<const Eigen::VectorXd>& q, const SceneData& data);

}  // namespace manycontact
