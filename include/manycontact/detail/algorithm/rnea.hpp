#pragma once
// Inverse dynamics. Source: Featherstone (2008), table 5.1, written in the tree frame.

#include <span>

#include "manycontact/detail/algorithm/kinematics.hpp"

namespace manycontact {

/// Computes tau (nv) by the backward pass of inverse dynamics, after forward_kinematics and forward_accelerations. If
/// `qdd` is given, armature is included. fext: njoints external forces on the bodies in the tree frame, or empty. f
/// (njoints) receives the force through each joint, in the tree frame. Allocates nothing.
template <class S>
void inverse_dynamics(const Model& model, const Kinematics<S>& kin, const S* qdd, std::span<const Vec6<S>> fext,
                      std::vector<Vec6<S>>& f, VecRef<S> tau);

/// Computes tau = M(q) qdd + h(q, v) - sum J^T fext. q: nq; v, qdd, tau: nv. fext: njoints external forces, each in its
/// body's child frame (Pinocchio's convention), or empty. `kin` and `f` are workspace, overwritten.
template <class S>
void rnea(const Model& model, const SE3<double>& base, const ConstVecRef<S>& q, const ConstVecRef<S>& v,
          const ConstVecRef<S>& qdd, const Vec3<double>& gravity, std::span<const Vec6<S>> fext, Kinematics<S>& kin,
          std::vector<Vec6<S>>& f, VecRef<S> tau);

}  // namespace manycontact
