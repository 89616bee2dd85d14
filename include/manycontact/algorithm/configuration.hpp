#pragma once
// Configurations q of a scene, one robot or a model (model/rigid_bodies.hpp), and operations on their manifold. q has
// nq entries [m, rad, unit quaternions], v has nv entries [m, rad]. All functions are thread-safe and take linear time.
// They throw std::invalid_argument for wrong sizes, and for configurations that solve would refuse.

#include <random>

#include "manycontact/model/rigid_bodies.hpp"

namespace manycontact {

/// Returns the configuration with all joints at zero and floating bases at Robot::base.
Eigen::VectorXd neutral(const RigidBodies& bodies);

/// Samples a configuration uniformly within the joints' limits. Coordinates without limits are within +-pi or +-1 m; a
/// coordinate with one limit is at most 2 pi or 2 m away from this limit. Floating bases are within +-1 m of
/// Robot::base, with any orientation.
Eigen::VectorXd random_configuration(const RigidBodies& bodies, std::mt19937& generator);

/// Samples velocities uniformly within the joints' limits; without limits, within +-1 m/s or rad/s.
Eigen::VectorXd random_velocity(const RigidBodies& bodies, std::mt19937& generator);

/// Computes q (+) v: the configuration reached from q with the constant velocity v in unit time. `out` (nq) may be q.
void integrate(const RigidBodies& bodies, const ConstVectorRef& q, const ConstVectorRef& v, VectorRef out);
Eigen::VectorXd integrate(const RigidBodies& bodies, const ConstVectorRef& q, const ConstVectorRef& v);

/// Computes q1 (-) q0: the velocity v (nv) with integrate(bodies, q0, v) = q1.
void difference(const RigidBodies& bodies, const ConstVectorRef& q0, const ConstVectorRef& q1, VectorRef out);
Eigen::VectorXd difference(const RigidBodies& bodies, const ConstVectorRef& q0, const ConstVectorRef& q1);

/// Computes q0 (+) share (q1 (-) q0): q0 for share = 0, q1 for share = 1, with constant velocity in between.
Eigen::VectorXd interpolate(const RigidBodies& bodies, const ConstVectorRef& q0, const ConstVectorRef& q1,
                            double share);

/// The derivatives of q (+) v with respect to q and v, nv x nv each, on the tangent spaces at q and q (+) v.
struct IntegrateDerivatives {
  Eigen::MatrixXd dq, dv;
};
/// Computes both derivatives of integrate(bodies, q, v) as dense matrices; allocates.
IntegrateDerivatives integrate_derivatives(const RigidBodies& bodies, const ConstVectorRef& q, const ConstVectorRef& v);

/// The derivatives of q1 (-) q0 with respect to q0 and q1, nv x nv each, on the tangent spaces at q0 and q1.
struct DifferenceDerivatives {
  Eigen::MatrixXd dq0, dq1;
};
/// Computes both derivatives of difference(bodies, q0, q1) as dense matrices; allocates.
DifferenceDerivatives difference_derivatives(const RigidBodies& bodies, const ConstVectorRef& q0,
                                             const ConstVectorRef& q1);

}  // namespace manycontact
