#pragma once
// Joint-space inertia M. Source: Featherstone (2008), table 6.2, written in the tree frame.
//
// M is stored in packed form. Row i contains M(i, i), M(i, p), M(i, p'), ... along the ancestors p = dof_parent[i],
// ..., and starts at model.M_begin[i]. All other entries of the lower triangle are zero.

#include "manycontact/detail/algorithm/kinematics.hpp"

namespace manycontact {

/// Computes the packed M (model.M_begin[nv] entries), armature included. Call it after forward_kinematics. Yc (njoints)
/// receives the composite inertias. Allocates nothing.
template <class S>
void crba(const Model& model, const Kinematics<S>& kin, std::vector<Inertia<S>>& Yc, S* M);

/// Computes M and stores entry k of its packed form in M[slot[k]], for a larger matrix with M as a block.
template <class S>
void crba(const Model& model, const Kinematics<S>& kin, std::vector<Inertia<S>>& Yc, const int* slot, S* M);

/// Expands a packed M into a dense symmetric matrix `out` (nv x nv).
template <class S>
void unpack_inertia(const Model& model, const S* M, MatRef<S> out);

}  // namespace manycontact
