#pragma once
// Joint-space inertia. Source: Featherstone (2008), table 6.2, written in the tree frame.
//
// M is stored packed: row i holds M(i, i), M(i, p), M(i, p'), ... along the ancestors p = dof_parent[i], ... and starts
// at model.M_begin[i]. Everything else of the lower triangle is zero.

#include "manycontact/algorithm/kinematics.hpp"

namespace manycontact {

/// M, armature included, after forward_kinematics. Yc: njoints, overwritten with composite inertias. M: M_begin[nv].
template <class S>
void crba(const Model& model, const Kinematics<S>& kin, std::vector<Inertia<S>>& Yc, S* M);

/// The same with entry k of M in M[slot[k]], for a matrix that M is a part of.
template <class S>
void crba(const Model& model, const Kinematics<S>& kin, std::vector<Inertia<S>>& Yc, const int* slot, S* M);

/// The dense symmetric matrix of a packed one. out: nv x nv.
template <class S>
void unpack_inertia(const Model& model, const S* M, MatRef<S> out);

}  // namespace manycontact
