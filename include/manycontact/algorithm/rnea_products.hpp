#pragma once
// Products with RNEA's derivatives without the matrices: one recursion forth and back, cost linear in the bodies.
// Everything is in the tree frame. A displacement dq moves body i by the motion xi_i = sum of S_j dq_j along its chain.
// Source: the forward and reverse modes of Featherstone's RNEA in an inertial frame; derivation ours.

#include "manycontact/algorithm/kinematics.hpp"

namespace manycontact {

/// Per body: how it and its motion change along a direction (tangent), or what a scalar's change per unit of each is
/// (adjoint: forces).
struct BodyVariation {
  Vec6<double> xi, u, v, a;  // displacement; virtual velocity (adjoint only); velocity; acceleration
};

/// The tangent's forward pass: xi, v, a of every body along (dq, dv) with qdd held. kin: after forward_accelerations
/// with qdd. dq, dv, qdd: nv. out: njoints.
void tangent_motions(const Model& model, const Kinematics<double>& kin, const double* qdd, const double* dq,
                     const double* dv, std::vector<BodyVariation>& out);

/// The tangent's backward pass: d tau = d ID. fext, dfext: njoints, external forces and their changes; f, df: njoints
/// scratch. dtau: nv.
void tangent_torques(const Model& model, const Kinematics<double>& kin, const std::vector<BodyVariation>& motion,
                     const std::vector<Vec6<double>>& fext, const std::vector<Vec6<double>>& dfext,
                     std::vector<Vec6<double>>& f, std::vector<Vec6<double>>& df, double* dtau);

/// Virtual velocities u_i = sum of S_j w_j along the chain. w: nv. u: njoints.
void virtual_velocities(const Model& model, const Kinematics<double>& kin, const double* w,
                        std::vector<Vec6<double>>& u);

/// Adds the gradients of w^T ID(q, v, qdd), without external forces, with respect to each body's xi, u, v, a.
void add_body_adjoints(const Model& model, const Kinematics<double>& kin, const std::vector<Vec6<double>>& u,
                       std::vector<BodyVariation>& adjoint);

/// From gradients per body to gradients per coordinate: wq, wv (nv each), of a scalar that depends on q, v through the
/// bodies' xi, u, v, a. qdd, and w inside u, are held. Overwrites `adjoint` with sums over subtrees.
void pull_back(const Model& model, const Kinematics<double>& kin, const double* qdd, const std::vector<Vec6<double>>& u,
               std::vector<BodyVariation>& adjoint, double* wq, double* wv);

}  // namespace manycontact
