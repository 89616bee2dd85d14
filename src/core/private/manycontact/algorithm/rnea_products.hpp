#pragma once
// Products with derivatives of RNEA, ID(q, v, qdd), in time linear in the bodies, in the tree frame. Along dq, body i
// moves by xi_i, the sum of S_j dq_j along its chain. Source: forward and reverse modes of RNEA; derivation ours.

#include "manycontact/detail/algorithm/kinematics.hpp"

namespace manycontact {

/// Changes of a body's placement and motion along (dq, dv) or, in adjoint functions, gradients with respect to these.
template <class S>
struct BodyVariationOf {
  Vec6<S> xi, u, v, a;  // displacement; virtual velocity (adjoint only); velocity; acceleration
};
using BodyVariation = BodyVariationOf<double>;

/// Computes the changes xi, v, a of every body along (dq, dv) at constant qdd, the forward pass of the tangent. `kin`:
/// after forward_accelerations with qdd. Sizes: dq, dv, qdd nv; out njoints.
template <class S>
void tangent_motions(const Model& model, const Kinematics<S>& kin, const S* qdd, const S* dq, const S* dv,
                     std::vector<BodyVariationOf<S>>& out);

/// Computes dtau (nv), the change of ID, from the result `motion` of tangent_motions. fext, dfext: external forces and
/// their changes.
template <class S>
void tangent_torques(const Model& model, const Kinematics<S>& kin, const std::vector<BodyVariationOf<S>>& motion,
                     const std::vector<Vec6<S>>& fext, const std::vector<Vec6<S>>& dfext, std::vector<Vec6<S>>& f,
                     std::vector<Vec6<S>>& df, S* dtau);

/// Computes the virtual velocities u_i of bodies, the sum of S_j w_j over the joints j above body i. w: nv. u: njoints.
template <class S>
void virtual_velocities(const Model& model, const Kinematics<S>& kin, const S* w, std::vector<Vec6<S>>& u);

/// Adds to `adjoint` the gradients of w^T ID(q, v, qdd), without external forces, with respect to the xi, u, v, a of
/// each body. u: virtual_velocities of w.
template <class S>
void add_body_adjoints(const Model& model, const Kinematics<S>& kin, const std::vector<Vec6<S>>& u,
                       std::vector<BodyVariationOf<S>>& adjoint);

/// Computes the gradients wq, wv (nv) of a scalar from `adjoint`, its gradients with respect to the bodies' xi, u, v,
/// a, at constant qdd and w. Overwrites `adjoint` with sums over subtrees.
template <class S>
void pull_back(const Model& model, const Kinematics<S>& kin, const S* qdd, const std::vector<Vec6<S>>& u,
               std::vector<BodyVariationOf<S>>& adjoint, S* wq, S* wv);

}  // namespace manycontact
