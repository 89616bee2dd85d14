#pragma once
// Dynamics and kinematics of robots without contacts, in double precision. Most functions correspond to functions of
// Pinocchio. The first argument of a function is a scene, one robot of a scene, or a model (model/rigid_bodies.hpp).
//
//     RigidBodyData data(scene);
//     const Eigen::VectorXd& tau = rnea(scene, q, v, a, data);
//     const Vec6<double> foot = frame_velocity(scene, data, find_frame(scene, "talos/left_sole"));
//
// q has nq entries; v, a and tau have nv. Units are SI; motions and forces have their linear part first. The equations
// of motion are
//
//     M(q) a + h(q, v) = tau + sum J^T fext        h = C(q, v) v + g(q) - tau_f(v) - tau_s(q)
//
// The armature is on the diagonal of M. The term tau_f is the damping and friction of joints, if the model has them
// (Model::damping); tau_s is the torque of the scene's joint springs (Scene::joint_springs). The argument fext has one
// force per joint, robot by robot, each on the joint's body in its child frame, or is empty. In derivatives, each force
// is fixed to its body. `forces_on_bodies` (contact/jacobian.hpp) computes the forces of contacts, external wrenches
// and springs between points.
//
// State of the data: each algorithm stores the q, v and a that it was called with, and zero for a missing v or a. The
// functions under "at the state of the data" use these stored values.
//
// Lifetime: returned references remain valid until the next call of the same function. Threads: all functions are
// thread-safe for distinct data. Memory: after the first call, only functions that return a value allocate. Errors: all
// functions throw std::invalid_argument for wrong sizes, for q or v that solve would refuse, and for data of other
// robots. Cost is linear in the number of joints unless stated otherwise.

#include <span>

#include "manycontact/model/rigid_bodies.hpp"

namespace manycontact {

namespace internal {
struct RigidBodyMemory;
}

struct RigidBodyData {                                // Workspace and state of the functions; one per thread.
  explicit RigidBodyData(const RigidBodies& bodies);  // makes data at the neutral configuration, at rest
  ~RigidBodyData();
  RigidBodyData(RigidBodyData&&) noexcept;  // afterwards the moved-from data belong to no robots
  RigidBodyData& operator=(RigidBodyData&&) noexcept;

  std::unique_ptr<internal::RigidBodyMemory> memory;
};

// ---- dynamics ------------------------------------------------------------------------------------------------------

using ForcesOnBodies = std::span<const Vec6<double>>;  // one force per joint (njoints), or an empty span

/// Computes the torques tau = M a + h - sum J^T fext (nv) [N m, N] that cause the accelerations a (inverse dynamics).
/// The reference remains valid until the next call. Throws std::invalid_argument for wrong sizes.
const Eigen::VectorXd& rnea(const RigidBodies& bodies, const ConstVectorRef& q, const ConstVectorRef& v,
                            const ConstVectorRef& a, RigidBodyData& data, ForcesOnBodies fext = {});
/// Compute h(q, v), and the torques g(q) - tau_s(q) that compensate gravity and springs (nv each) [N m, N]. A reference
/// remains valid until the next call of its function. Both functions throw std::invalid_argument for wrong sizes.
const Eigen::VectorXd& nonlinear_effects(const RigidBodies& bodies, const ConstVectorRef& q, const ConstVectorRef& v,
                                         RigidBodyData& data);
const Eigen::VectorXd& gravity_torques(const RigidBodies& bodies, const ConstVectorRef& q, RigidBodyData& data);
/// Computes a = M^-1 (tau - h + sum J^T fext) (nv) [m/s^2, rad/s^2] with the articulated-body algorithm. The result is
/// NaN for a robot whose M is singular; massless_coordinates (analysis/findings.hpp) finds the joints that cause it.
/// Throws std::invalid_argument for wrong sizes.
const Eigen::VectorXd& aba(const RigidBodies& bodies, const ConstVectorRef& q, const ConstVectorRef& v,
                           const ConstVectorRef& tau, RigidBodyData& data, ForcesOnBodies fext = {});
/// Computes the inertia matrix M (nv x nv), symmetric, with zero blocks between robots. Memory: nv^2 numbers. Throws
/// std::length_error for trees that are too deep, std::invalid_argument for a wrong size.
const Eigen::MatrixXd& crba(const RigidBodies& bodies, const ConstVectorRef& q, RigidBodyData& data);
/// Computes M^-1 X for a matrix X with nv rows, with the factorization M = L^T D L along the trees. Neither M nor its
/// inverse is formed. Rows of robots whose M is singular are NaN. Throws std::invalid_argument for wrong sizes.
Eigen::MatrixXd inverse_inertia_times(const RigidBodies& bodies, const ConstVectorRef& q,
                                      const Eigen::Ref<const Eigen::MatrixXd>& X, RigidBodyData& data);
/// Computes the Coriolis matrix C (nv x nv) by Christoffel symbols, so that dM/dt - 2 C is skew-symmetric. Memory: nv^2
/// numbers. Throws std::invalid_argument for wrong sizes. Source: Echeandia, Wensing, Numerical methods to compute the
/// Coriolis matrix and Christoffel symbols for rigid-body systems, J. Comput. Nonlinear Dynam. 16 (2021).
Eigen::MatrixXd coriolis_matrix(const RigidBodies& bodies, const ConstVectorRef& q, const ConstVectorRef& v,
                                RigidBodyData& data);

/// The derivatives of rnea's tau with respect to q, v and a (nv x nv each); dq is on the tangent space.
struct TorqueDerivatives {
  Eigen::MatrixXd dq, dv, da;
};
/// Computes the derivatives of rnea(bodies, q, v, a, data, fext). Each fext is fixed to its body. The reference remains
/// valid until the next call. Throws std::invalid_argument for wrong sizes.
const TorqueDerivatives& rnea_derivatives(const RigidBodies& bodies, const ConstVectorRef& q, const ConstVectorRef& v,
                                          const ConstVectorRef& a, RigidBodyData& data, ForcesOnBodies fext = {});
/// The derivatives of aba's a with respect to q, v and tau (nv x nv each); dq is on the tangent space, dtau is M^-1.
struct AccelerationDerivatives {
  Eigen::MatrixXd dq, dv, dtau;
};
/// Computes the derivatives of aba(bodies, q, v, tau, data, fext). Each fext is fixed to its body. The reference
/// remains valid until the next call. Cost: O(nv^3) per tree. Throws std::invalid_argument for wrong sizes.
const AccelerationDerivatives& aba_derivatives(const RigidBodies& bodies, const ConstVectorRef& q,
                                               const ConstVectorRef& v, const ConstVectorRef& tau, RigidBodyData& data,
                                               ForcesOnBodies fext = {});

// ---- state ---------------------------------------------------------------------------------------------------------

/// Sets the state of the data to q, v and a; a missing v or a is zero. Throws std::invalid_argument for wrong sizes.
void forward_kinematics(const RigidBodies& bodies, const ConstVectorRef& q, RigidBodyData& data);
void forward_kinematics(const RigidBodies& bodies, const ConstVectorRef& q, const ConstVectorRef& v,
                        RigidBodyData& data);
void forward_kinematics(const RigidBodies& bodies, const ConstVectorRef& q, const ConstVectorRef& v,
                        const ConstVectorRef& a, RigidBodyData& data);

// ---- frames, at the state of the data ------------------------------------------------------------------------------
// `axes` selects the reference frame. Local: the frame's axes, at its origin. World: the world's axes, at the world's
// origin. Local_world_aligned: the world's axes, at the frame's origin. `frame` is a result of find_frame or attach;
// a frame of the world is at rest.

/// Returns the placement oMf of a frame in the world.
SE3<double> frame_placement(const RigidBodies& bodies, const RigidBodyData& data, const Attachment& frame);
/// Computes the spatial velocity of a frame: linear [m/s], angular [rad/s].
Vec6<double> frame_velocity(const RigidBodies& bodies, RigidBodyData& data, const Attachment& frame,
                            ReferenceFrame axes = ReferenceFrame::kLocal);
/// Compute the spatial and the classical acceleration of a frame [m/s^2, rad/s^2]. The linear part of the classical one
/// is the acceleration of the frame's origin as a point.
Vec6<double> frame_acceleration(const RigidBodies& bodies, RigidBodyData& data, const Attachment& frame,
                                ReferenceFrame axes = ReferenceFrame::kLocal);
Vec6<double> frame_classical_acceleration(const RigidBodies& bodies, RigidBodyData& data, const Attachment& frame,
                                          ReferenceFrame axes = ReferenceFrame::kLocal);
/// Computes the Jacobian J (6 x nv) of a frame, with frame_velocity = J v. Allocates the result.
Mat6X<double> frame_jacobian(const RigidBodies& bodies, const RigidBodyData& data, const Attachment& frame,
                             ReferenceFrame axes = ReferenceFrame::kLocal);
/// Computes the bias acceleration (dJ/dt) v of a frame: the rate of frame_velocity for a = 0. In local and world axes
/// it is the spatial acceleration, in local_world_aligned axes the classical one.
Vec6<double> frame_bias_acceleration(const RigidBodies& bodies, RigidBodyData& data, const Attachment& frame,
                                     ReferenceFrame axes = ReferenceFrame::kLocal);

// ---- quantities of the whole, at the state of the data -------------------------------------------------------------
// All moving bodies contribute. Results are in the world's axes. Bodies merged into a fixed base are not part of a
// model. Results are NaN if the total mass is zero.

/// Returns the total mass of the moving bodies [kg].
double total_mass(const RigidBodies& bodies);
/// Returns the centre of mass in the world [m].
Vec3<double> center_of_mass(const RigidBodies& bodies, const RigidBodyData& data);
/// Returns the velocity of the centre of mass [m/s].
Vec3<double> center_of_mass_velocity(const RigidBodies& bodies, RigidBodyData& data);
/// Returns the acceleration of the centre of mass [m/s^2].
Vec3<double> center_of_mass_acceleration(const RigidBodies& bodies, RigidBodyData& data);
/// Returns the Jacobian J (3 x nv) of the centre of mass, whose velocity is J v. Allocates the result.
Eigen::Matrix3Xd center_of_mass_jacobian(const RigidBodies& bodies, RigidBodyData& data);
/// Compute the momentum A v about the centre of mass, the matrix A (6 x nv), and the rate of the momentum, dA/dt v + A
/// a. Momentum is linear [N s], then angular [N m s], and the rate is in [N, N m]. The rate equals the sum of all
/// external wrenches about the centre of mass. Rotors (armature) do not contribute.
Vec6<double> centroidal_momentum(const RigidBodies& bodies, RigidBodyData& data);
Mat6X<double> centroidal_momentum_matrix(const RigidBodies& bodies, RigidBodyData& data);
Vec6<double> centroidal_momentum_rate(const RigidBodies& bodies, RigidBodyData& data);
/// Compute the kinetic energy [J], rotors included, and the potential energy [J] of weight and joint springs. The
/// energy of weight is zero at the world's origin.
double kinetic_energy(const RigidBodies& bodies, RigidBodyData& data);
double potential_energy(const RigidBodies& bodies, const RigidBodyData& data);

// ---- joints --------------------------------------------------------------------------------------------------------

/// Returns the wrench that a joint transmits to its child body: force [N] and moment [N m], in the child frame and
/// about its origin, from the last rnea, nonlinear_effects or gravity_torques. The child is the joint's child link in
/// the file, also if another root link was selected. The component along the joint is tau without the torques of
/// armature, joint friction and joint spring. External forces are included if they were given to rnea as fext; see
/// forces_on_bodies (contact/jacobian.hpp). Throws std::logic_error unless one of these three functions was the last
/// that set the state of the data.
Vec6<double> joint_wrench(const RigidBodies& bodies, const RigidBodyData& data, const BodyJoint& joint);

}  // namespace manycontact
