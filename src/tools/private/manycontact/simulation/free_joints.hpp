#pragma once
// Floating and planar joints in a semi-implicit Euler step. The velocity v of such a joint is expressed in the axes R
// of its body. A step solves for x, the velocity at its end in the axes at its start, and ends with
//
//     p+ = p + h R x_linear        R+ = R exp(h x_angular)        v+ = R+^T R x
//
// A common velocity of all bodies then changes no relative motion (Galilean invariance). A screw motion q (+) h v would
// displace the origin by h^2 w x v / 2 more, with w the angular velocity, which differs between bodies.

#include "manycontact/model/scene.hpp"

namespace manycontact::internal {

/// Computes the acceleration a = -v / h - w x v with which a step ends at x = 0. v, a: nv. The term w x v, with w the
/// angular velocity, is only in translations of free joints.
void stop_in_a_step(const Scene& scene, const Eigen::VectorXd& v, double h, Eigen::VectorXd& a);
/// Returns the derivative of w x v with respect to the joint's velocity, which consists of w (angular) and v (linear).
using OfFreeJoint = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, 6, 6>;
OfFreeJoint derivative_of_turn(const Joint& joint, const ConstVectorRef& v);

/// Computes the state q+, v+ after a step from q with the solution x (nv). v_next may be x. scratch: nv.
void end_free_joints(const Scene& scene, const Eigen::VectorXd& q, const Eigen::VectorXd& x, double h,
                     Eigen::VectorXd& scratch, Eigen::VectorXd& q_next, Eigen::VectorXd& v_next);
/// Transforms F (2 nv rows) from [dq + h dx; dx] to the derivatives of q+ and v+. Allocates nothing.
void differentiate_free_joints(const Scene& scene, const Eigen::VectorXd& x, double h, Eigen::MatrixXd& F);

}  // namespace manycontact::internal
