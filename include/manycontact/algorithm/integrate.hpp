#pragma once
// The configuration manifold of one robot. Tangent vectors live in each joint's own child frame.

#include "manycontact/model/model.hpp"

namespace manycontact {

/// out = q (+) v: the configuration reached from q by the velocity v held for unit time. q, out: nq; v: nv.
template <class S>
void integrate(const Model& model, const ConstVecRef<S>& q, const ConstVecRef<S>& v, VecRef<S> out);

/// out = q1 (-) q0: the v with integrate(q0, v) = q1. q0, q1: nq; out: nv.
template <class S>
void difference(const Model& model, const ConstVecRef<S>& q0, const ConstVecRef<S>& q1, VecRef<S> out);

/// The block of one joint, nv x nv, of d(q (+) v)/dv, or with `of_q` of d(q (+) v)/dq: no other is not zero. v: the
/// joint's. By q on the tangent spaces there and at q (+) v.
void joint_integrate_derivative(const Joint& joint, const Eigen::Ref<const Eigen::VectorXd>& v, bool of_q,
                                Eigen::Ref<Eigen::MatrixXd> J);

/// The same of d(q1 (-) q0)/dq1, or with `of_q0` of d(q1 (-) q0)/dq0. v: q1 (-) q0 of the joint.
void joint_difference_derivative(const Joint& joint, const Eigen::Ref<const Eigen::VectorXd>& v, bool of_q0,
                                 Eigen::Ref<Eigen::MatrixXd> J);

}  // namespace manycontact
