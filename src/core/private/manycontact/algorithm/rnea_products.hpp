#pragma once
// Products with the derivatives of RNEA, ID(q, v, qdd), without matrices: one forward and one backward recursion,
// linear in the bodies. All motions are in the tree frame. A displacement dq moves body i by xi_i, the sum of S_j dq_j
// along its chain. Source: forward and reverse modes of Featherstone's RNEA in an inertial frame; derivation ours.

#include "manycontact/detail/algorithm/kinematics.hpp"

namespace manycontact {

/// Changes of one body's placement and motion along a direction; as adjoint, gradients with respect to these (forces).
template <class S>
struct BodyVariationOf {
  Vec6<S> xi, u, v, a;  // displacement; virtual velocity (adjoint only); velocity; acceleration
};
using BodyVariation = BodyVariationOf<double>;

/// Forward pass of the tangent: computes xi, v, a of every body along (dq, dv) at constant qdd. `kin`: after
/// forward_accelerations with qdd. Sizes: dq, dv, qdd nv; out njoints.
template <class S>
void tangent_motions(const Model& model, const Kinematics<S>& kin, const S* qdd, const S* dq, const S* dv,
                     std::vector<BodyVariationOf<S>>& out);

/// Backward pass of the tangent: dtau (nv), the change of ID. fext, dfext: external forces, changes; f, df: scratch.
template <class S>
void tangent_torques(const Model& model, const Kinematics<S>& kin, const std::vector<BodyVariationOf<S>>& motion,
                     const std::vector<Vec6<S>>& fext, const std::vector<Vec6<S>>& dfext, std::vector<Vec6<S>>& f,
                     std::vector<Vec6<S>>& df, S* dtau);

/// Computes virtual velocities u_i = sum of S_j w_j along the chain. w: nv. u: njoints.
template <class S>
void virtual_velocities(const Model& model, const Kinematics<S>& kin, const S* w, std::vector<Vec6<S>>& u);

/// Adds the gradients of w^T ID(q, v, qdd), without external forces, with respect to the xi, u, v, a of each body.
template <class S>
void add_body_adjoints(const Model& model, const Kinematics<S>& kin, const std::vector<Vec6<S>>& u,
                       std::vector<BodyVariationOf<S>>& adjoint);

/// Converts gradients per body to gradients per coordinate, wq and wv (nv each), of a scalar that depends on q, v
/// through the bodies' xi, u, v, a. qdd, and w in u, are constant. Overwrites `adjoint` with sums over subtrees.
template <class S>
void pull_back(const Model& model, const Kinematics<S>& kin, const S* qdd, const std::vector<Vec6<S>>& u,
               std::vector<BodyVariationOf<S>>& adjoint, S* wq, S* wv);

}  // namespace manycontact
