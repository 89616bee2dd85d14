#pragma once
// The configuration manifold of one robot. Tangent vectors are expressed in each joint's own child frame.

#include "manycontact/model/model.hpp"

namespace manycontact {

/// Computes out = q (+) v: the configuration reached from q with constant velocity v in unit time. q, out: nq; v: nv.
template <class S>
void integrate(const Model& model, const ConstVecRef<S>& q, const ConstVecRef<S>& v, VecRef<S> out);

/// Computes out = q1 (-) q0: the velocity v with integrate(q0, v) = q1. q0, q1: nq; out: nv.
template <class S>
void difference(const Model& model, const ConstVecRef<S>& q0, const ConstVecRef<S>& q1, VecRef<S> out);

/// Computes a joint's block J of d(q (+) v)/dv, or of d(q (+) v)/dq if `of_q`; entries outside of the joints' blocks
/// are zero. v: the joint's velocity coordinates. Derivatives with respect to q are on the tangent spaces at q and q
/// (+) v.
void joint_integrate_derivative(const Joint& joint, const ConstVectorRef& v, bool of_q, Eigen::Ref<Eigen::MatrixXd> J);

/// Computes a joint's block J of d(q1 (-) q0)/dq1, or of d(q1 (-) q0)/dq0 if `of_q0`. v: the joint's q1 (-) q0.
void joint_difference_derivative(const Joint& joint, const ConstVectorRef& v, bool of_q0,
                                 Eigen::Ref<Eigen::MatrixXd> J);

}  // namespace manycontact
