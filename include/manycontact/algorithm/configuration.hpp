#pragma once
// Configurations of a scene, one robot or a model (model/rigid_bodies.hpp): where to start, and the manifold they live
// on (algorithm/integrate.hpp per joint). q: nq, v: nv; std::invalid_argument where solve would refuse them.

#include <random>

#include "manycontact/model/rigid_bodies.hpp"

namespace manycontact {

/// Joints at zero, floating bases where Robot::base has them.
Eigen::VectorXd neutral(const RigidBodies& bodies);

/// Uniform within the joints' limits. Where there are none: angles within +-pi, displacements within +-1 m; with one
/// limit alone, within that range from it. Floating bases within +-1 m of Robot::base; any orientation.
Eigen::VectorXd random_configuration(const RigidBodies& bodies, std::mt19937& generator);

/// Uniform within the joints' velocity limits; where there are none, within +-1 m/s, rad/s.
Eigen::VectorXd random_velocity(const RigidBodies& bodies, std::mt19937& generator);

/// q (+) v: reached from q by the velocity v held for unit time. `out` may be q.
void integrate(const RigidBodies& bodies, const Eigen::Ref<const Eigen::VectorXd>& q,
               const Eigen::Ref<const Eigen::VectorXd>& v, Eigen::Ref<Eigen::VectorXd> out);
Eigen::VectorXd integrate(const RigidBodies& bodies, const Eigen::Ref<const Eigen::VectorXd>& q,
                          const Eigen::Ref<const Eigen::VectorXd>& v);

/// q1 (-) q0: the v with integrate(bodies, q0, v) = q1.
void difference(const RigidBodies& bodies, const Eigen::Ref<const Eigen::VectorXd>& q0,
                const Eigen::Ref<const Eigen::VectorXd>& q1, Eigen::Ref<Eigen::VectorXd> out);
Eigen::VectorXd difference(const RigidBodies& bodies, const Eigen::Ref<const Eigen::VectorXd>& q0,
                           const Eigen::Ref<const Eigen::VectorXd>& q1);

/// q0 (+) share (q1 (-) q0): q0 at 0, q1 at 1, at constant velocity between.
Eigen::VectorXd interpolate(const RigidBodies& bodies, const Eigen::Ref<const Eigen::VectorXd>& q0,
                            const Eigen::Ref<const Eigen::VectorXd>& q1, double share);

struct IntegrateDerivatives {  // Of q (+) v, nv x nv each, on the tangent spaces at q and q (+) v.
  Eigen::MatrixXd dq, dv;
};
/// Both at once.
IntegrateDerivatives integrate_derivatives(const RigidBodies& bodies, const Eigen::Ref<const Eigen::VectorXd>& q,
                                           const Eigen::Ref<const Eigen::VectorXd>& v);

struct DifferenceDerivatives {  // Of q1 (-) q0, nv x nv each, on the tangent spaces at q0 and q1.
  Eigen::MatrixXd dq0, dq1;
};
/// Both at once.
DifferenceDerivatives difference_derivatives(const RigidBodies& bodies, const Eigen::Ref<const Eigen::VectorXd>& q0,
                                             const Eigen::Ref<const Eigen::VectorXd>& q1);

}  // namespace manycontact
