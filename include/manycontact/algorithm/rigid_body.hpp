#pragma once
// Dynamics and kinematics of robots without contacts, in doubles: what Pinocchio's users reach for. The first argument
// is a scene, one of its robots, or a model (model/rigid_bodies.hpp); data belong to what they were made for.
//
//     RigidBodyData data(scene);
//     const Eigen::VectorXd& tau = rnea(scene, q, v, a, data);
//     const Vec6<double> foot = frame_velocity(scene, data, frame_called(scene, "talos/left_sole"));
//
// q: nq; v, a, tau: nv. SI units; motions and forces have their linear part first. The equations of motion are
//
//     M(q) a + h(q, v) = tau + sum J^T fext        h = C(q, v) v + g(q) - tau_f(v) - tau_s(q)
//
// with the armature on M's diagonal, tau_f the damping and friction of joints where the model has them
// (Model::damping), and tau_s the springs in joints of a scene (Scene::joint_springs), as in solve. A scene's pushes
// and springs between points are fext (forces_on_bodies of contact/jacobian.hpp). fext: njoints forces on the bodies,
// robot by robot, each in its joint's child frame, fixed to it when derivatives are taken; or none.
//
// Each algorithm leaves the data at its q and v (v = 0 where it takes none) and, where it takes accelerations, at
// those, else at a = 0; what stands under "at the data's state" is of that. Returned references hold until the next
// call of the same function. Nothing is allocated after the first call but by functions that return a value. All throw
// std::invalid_argument where sizes do not fit, solve would refuse q or v, or the data are of other robots.

#include <span>

#include "manycontact/model/rigid_bodies.hpp"

namespace manycontact {

namespace internal {
struct RigidBodyMemory;
}

struct RigidBodyData {                                // State and memory of these functions; one per thread.
  explicit RigidBodyData(const RigidBodies& bodies);  // at the neutral configuration, at rest
  ~RigidBodyData();
  RigidBodyData(RigidBodyData&&) noexcept;  // moved from, it is of no robots
  RigidBodyData& operator=(RigidBodyData&&) noexcept;

  std::unique_ptr<internal::RigidBodyMemory> memory;
};

// ---- dynamics ------------------------------------------------------------------------------------------------------

using ForcesOnBodies = std::span<const Vec6<double>>;  // njoints of them, or none

/// tau = M a + h - sum J^T fext: the torques that give a.
const Eigen::VectorXd& rnea(const RigidBodies& bodies, const Eigen::Ref<const Eigen::VectorXd>& q,
                            const Eigen::Ref<const Eigen::VectorXd>& v, const Eigen::Ref<const Eigen::VectorXd>& a,
                            RigidBodyData& data, ForcesOnBodies fext = {});
/// h(q, v), and g(q) - tau_s(q): the torques that hold the robots still.
const Eigen::VectorXd& nonlinear_effects(const RigidBodies& bodies, const Eigen::Ref<const Eigen::VectorXd>& q,
                                         const Eigen::Ref<const Eigen::VectorXd>& v, RigidBodyData& data);
const Eigen::VectorXd& gravity_torques(const RigidBodies& bodies, const Eigen::Ref<const Eigen::VectorXd>& q,
                                       RigidBodyData& data);
/// a = M^-1 (tau - h + sum J^T fext), by articulated bodies. NaN for a robot whose M is singular
/// (massless_coordinates of analysis/findings.hpp says where).
const Eigen::VectorXd& aba(const RigidBodies& bodies, const Eigen::Ref<const Eigen::VectorXd>& q,
                           const Eigen::Ref<const Eigen::VectorXd>& v, const Eigen::Ref<const Eigen::VectorXd>& tau,
                           RigidBodyData& data, ForcesOnBodies fext = {});
/// M: nv x nv, symmetric; zero between robots. Throws std::length_error for trees too deep for it.
const Eigen::MatrixXd& crba(const RigidBodies& bodies, const Eigen::Ref<const Eigen::VectorXd>& q, RigidBodyData& data);
/// M^-1 X for the columns of X (nv rows), by M = L^T D L along the trees; neither M nor its inverse is formed. NaN for
/// robots whose M is singular.
Eigen::MatrixXd inverse_inertia_times(const RigidBodies& bodies, const Eigen::Ref<const Eigen::VectorXd>& q,
                                      const Eigen::Ref<const Eigen::MatrixXd>& X, RigidBodyData& data);
/// C: nv x nv, the one of which dM/dt - 2 C is skew (Christoffel's). Source: Echeandia, Wensing, Numerical methods to
/// compute the Coriolis matrix and Christoffel symbols for rigid-body systems, J. Comput. Nonlinear Dynam. 16 (2021).
Eigen::MatrixXd coriolis_matrix(const RigidBodies& bodies, const Eigen::Ref<const Eigen::VectorXd>& q,
                                const Eigen::Ref<const Eigen::VectorXd>& v, RigidBodyData& data);

struct TorqueDerivatives {  // Of rnea's tau, nv x nv each; by q on the tangent space.
  Eigen::MatrixXd dq, dv, da;
};
/// All three, with fext fixed to the bodies.
const TorqueDerivatives& rnea_derivatives(const RigidBodies& bodies, const Eigen::Ref<const Eigen::VectorXd>& q,
                                          const Eigen::Ref<const Eigen::VectorXd>& v,
                                          const Eigen::Ref<const Eigen::VectorXd>& a, RigidBodyData& data,
                                          ForcesOnBodies fext = {});
struct AccelerationDerivatives {  // Of aba's a, nv x nv each; dtau is M^-1.
  Eigen::MatrixXd dq, dv, dtau;
};
/// All three, likewise.
const AccelerationDerivatives& aba_derivatives(const RigidBodies& bodies, const Eigen::Ref<const Eigen::VectorXd>& q,
                                               const Eigen::Ref<const Eigen::VectorXd>& v,
                                               const Eigen::Ref<const Eigen::VectorXd>& tau, RigidBodyData& data,
                                               ForcesOnBodies fext = {});

// ---- state ---------------------------------------------------------------------------------------------------------

/// Takes the data to q; with v = 0, a = 0 where these are not given.
void forward_kinematics(const RigidBodies& bodies, const Eigen::Ref<const Eigen::VectorXd>& q, RigidBodyData& data);
void forward_kinematics(const RigidBodies& bodies, const Eigen::Ref<const Eigen::VectorXd>& q,
                        const Eigen::Ref<const Eigen::VectorXd>& v, RigidBodyData& data);
void forward_kinematics(const RigidBodies& bodies, const Eigen::Ref<const Eigen::VectorXd>& q,
                        const Eigen::Ref<const Eigen::VectorXd>& v, const Eigen::Ref<const Eigen::VectorXd>& a,
                        RigidBodyData& data);

// ---- frames, at the data's state -----------------------------------------------------------------------------------
// Axes: local: the frame's own, at its origin; world: the world's, at the world's origin; local_world_aligned: the
// world's, at the frame's origin. frame: by frame_called or attach; one of the world stands still.

/// oMf, in the world.
SE3<double> frame_placement(const RigidBodies& bodies, const RigidBodyData& data, const Attachment& frame);
/// Spatial velocity, linear [m/s], angular [rad/s].
Vec6<double> frame_velocity(const RigidBodies& bodies, RigidBodyData& data, const Attachment& frame,
                            ReferenceFrame axes = ReferenceFrame::kLocal);
/// Spatial acceleration; and the classical one, whose linear part is the acceleration of the frame's origin as a point.
Vec6<double> frame_acceleration(const RigidBodies& bodies, RigidBodyData& data, const Attachment& frame,
                                ReferenceFrame axes = ReferenceFrame::kLocal);
Vec6<double> frame_classical_acceleration(const RigidBodies& bodies, RigidBodyData& data, const Attachment& frame,
                                          ReferenceFrame axes = ReferenceFrame::kLocal);
/// J, 6 x nv: frame_velocity = J v.
Mat6X<double> frame_jacobian(const RigidBodies& bodies, const RigidBodyData& data, const Attachment& frame,
                             ReferenceFrame axes = ReferenceFrame::kLocal);
/// (dJ/dt) v: what frame_velocity's numbers change by in time where a = 0. In local and world axes that is the spatial
/// acceleration there, in local_world_aligned ones the classical.
Vec6<double> frame_drift(const RigidBodies& bodies, RigidBodyData& data, const Attachment& frame,
                         ReferenceFrame axes = ReferenceFrame::kLocal);

// ---- the whole, at the data's state --------------------------------------------------------------------------------
// Of all bodies that move together, in the world's axes; those merged into a fixed base are not part of a model. NaN
// where there is no mass.

/// kg
double total_mass(const RigidBodies& bodies);
/// m
Vec3<double> center_of_mass(const RigidBodies& bodies, const RigidBodyData& data);
/// m/s
Vec3<double> center_of_mass_velocity(const RigidBodies& bodies, RigidBodyData& data);
/// m/s^2
Vec3<double> center_of_mass_acceleration(const RigidBodies& bodies, RigidBodyData& data);
/// 3 x nv: the velocity of the centre of mass is J v.
Eigen::Matrix3Xd center_of_mass_jacobian(const RigidBodies& bodies, RigidBodyData& data);
/// Momentum about the centre of mass: linear [N s], angular [N m s]; the matrix A with momentum = A v (6 x nv), and the
/// rate dA/dt v + A a [N, N m], which is the sum of all outer forces about it. Rotors (armature) have none.
Vec6<double> centroidal_momentum(const RigidBodies& bodies, RigidBodyData& data);
Mat6X<double> centroidal_momentum_matrix(const RigidBodies& bodies, RigidBodyData& data);
Vec6<double> centroidal_momentum_rate(const RigidBodies& bodies, RigidBodyData& data);
/// J; rotors included; of weight, zero at the world's origin, and of the springs in joints.
double kinetic_energy(const RigidBodies& bodies, RigidBodyData& data);
double potential_energy(const RigidBodies& bodies, const RigidBodyData& data);

// ---- joints --------------------------------------------------------------------------------------------------------

/// What a joint carries: the wrench on its child body, force [N] and moment [N m] in the child frame and about its
/// origin, by the last rnea, nonlinear_effects or gravity_torques. The child is the file's, whichever link is the root.
/// tau is its part along the joint, without the rotor's inertia, friction and spring. What acts from outside counts
/// where rnea is given it as fext: forces_on_bodies (contact/jacobian.hpp). Throws std::logic_error after anything
/// else.
Vec6<double> joint_wrench(const RigidBodies& bodies, const RigidBodyData& data, const BodyJoint& joint);

}  // namespace manycontact
