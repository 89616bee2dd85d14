#pragma once
// Docstrings of functions for rigid-body functions, in the layout of numpydoc.

namespace manycontact::python::doc {

// clang-format off
inline constexpr const char* rnea =
    R"(Compute inverse dynamics: the torques that cause the accelerations a, without contacts.

    tau = M(q) a + h(q, v) - sum J^T fext        h = C(q, v) v + g(q) - tau_f(v)

tau_f is the joints' friction, if it is modelled.

Parameters
----------
bodies : Scene, Model or RigidBodies
    All robots of a scene, a model at the origin, or a selection.
q : array (nq)
    Configuration [m, rad, unit quaternions].
v : array (nv)
    Velocity [m/s, rad/s].
a : array (nv)
    Accelerations [m/s^2, rad/s^2].
data : RigidBodyData, optional
    Workspace, set to this state; None: a new one.
fext : array (njoints, 6), optional
    Wrenches on the bodies, in their joints' child frames [N, N m].

Returns
-------
array (nv)
    Torques [N m, N].

Raises
------
ValueError
    A size does not fit, or a number is not finite.)";

inline constexpr const char* nonlinear_effects =
    R"(Compute h(q, v): the torques of gravity, Coriolis and centrifugal forces.

Parameters
----------
bodies : Scene, Model or RigidBodies
    All robots of a scene, a model at the origin, or a selection.
q : array (nq)
    Configuration [m, rad, unit quaternions].
v : array (nv)
    Velocity [m/s, rad/s].
data : RigidBodyData, optional
    Workspace, set to this state; None: a new one.

Returns
-------
array (nv)
    Torques [N m, N].

Raises
------
ValueError
    A size does not fit, or a number is not finite.)";

inline constexpr const char* gravity_torques =
    R"(Compute g(q): the torques that compensate gravity, without contacts.

Parameters
----------
bodies : Scene, Model or RigidBodies
    All robots of a scene, a model at the origin, or a selection.
q : array (nq)
    Configuration [m, rad, unit quaternions].
data : RigidBodyData, optional
    Workspace, set to this state; None: a new one.

Returns
-------
array (nv)
    Torques [N m, N].

Raises
------
ValueError
    A size does not fit, or a number is not finite.)";

inline constexpr const char* aba =
    R"(Compute forward dynamics: the accelerations caused by torques, without contacts.

Parameters
----------
bodies : Scene, Model or RigidBodies
    All robots of a scene, a model at the origin, or a selection.
q : array (nq)
    Configuration [m, rad, unit quaternions].
v : array (nv)
    Velocity [m/s, rad/s].
tau : array (nv)
    Torques [N m, N].
data : RigidBodyData, optional
    Workspace, set to this state; None: a new one.
fext : array (njoints, 6), optional
    Wrenches on the bodies, in their joints' child frames [N, N m].

Returns
-------
array (nv)
    Accelerations [m/s^2, rad/s^2]; NaN for a robot whose M is singular.

Raises
------
ValueError
    A size does not fit, or a number is not finite.)";

inline constexpr const char* crba =
    R"(Compute the joint-space inertia M, armature included.

Parameters
----------
bodies : Scene, Model or RigidBodies
    All robots of a scene, a model at the origin, or a selection.
q : array (nq)
    Configuration [m, rad, unit quaternions].
data : RigidBodyData, optional
    Workspace, set to this state; None: a new one.

Returns
-------
array (nv, nv)
    Symmetric, with zero blocks between robots.

Raises
------
ValueError
    A size does not fit, or a tree is too deep.)";

inline constexpr const char* inverse_inertia_times =
    R"(Compute M^-1 x with the factorization L^T D L along the trees; M^-1 is not formed.

Parameters
----------
bodies : Scene, Model or RigidBodies
    All robots of a scene, a model at the origin, or a selection.
q : array (nq)
    Configuration [m, rad, unit quaternions].
x : array (nv) or (nv, n)
data : RigidBodyData, optional
    Workspace, set to this state; None: a new one.

Returns
-------
array
    As x; NaN for a robot whose M is singular.

Raises
------
ValueError
    A size does not fit, or a number is not finite.)";

inline constexpr const char* coriolis_matrix =
    R"(Compute C(q, v): C v are the Coriolis and centrifugal torques, and dM/dt - 2 C is skew-symmetric.

Parameters
----------
bodies : Scene, Model or RigidBodies
    All robots of a scene, a model at the origin, or a selection.
q : array (nq)
    Configuration [m, rad, unit quaternions].
v : array (nv)
    Velocity [m/s, rad/s].
data : RigidBodyData, optional
    Workspace, set to this state; None: a new one.

Returns
-------
array (nv, nv)

Raises
------
ValueError
    A size does not fit, or a number is not finite.)";

inline constexpr const char* rnea_derivatives =
    R"(Compute the derivatives of rnea's torques.

Parameters
----------
bodies : Scene, Model or RigidBodies
    All robots of a scene, a model at the origin, or a selection.
q : array (nq)
    Configuration [m, rad, unit quaternions].
v : array (nv)
    Velocity [m/s, rad/s].
a : array (nv)
    Accelerations [m/s^2, rad/s^2].
data : RigidBodyData, optional
    Workspace, set to this state; None: a new one.
fext : array (njoints, 6), optional
    Wrenches fixed to the bodies, in their joints' child frames [N, N m].

Returns
-------
tuple of arrays (nv, nv)
    With respect to q (on the tangent space), v and a.

Raises
------
ValueError
    A size does not fit, or a number is not finite.)";

inline constexpr const char* aba_derivatives =
    R"(Compute the derivatives of aba's accelerations.

Parameters
----------
bodies : Scene, Model or RigidBodies
    All robots of a scene, a model at the origin, or a selection.
q : array (nq)
    Configuration [m, rad, unit quaternions].
v : array (nv)
    Velocity [m/s, rad/s].
tau : array (nv)
    Torques [N m, N].
data : RigidBodyData, optional
    Workspace, set to this state; None: a new one.
fext : array (njoints, 6), optional
    Wrenches fixed to the bodies, in their joints' child frames [N, N m].

Returns
-------
tuple of arrays (nv, nv)
    With respect to q (on the tangent space), v and tau.

Raises
------
ValueError
    A size does not fit, or a number is not finite.)";

inline constexpr const char* joint_wrench =
    R"(Return the wrench that a joint transmits to its child body.

It is that of the last rnea, nonlinear_effects or gravity_torques. With contacts, call rnea with
the accelerations of solve and fext=contact_forces_on_bodies(...).

Parameters
----------
bodies : Scene, Model or RigidBodies
    All robots of a scene, a model at the origin, or a selection.
data : RigidBodyData
joint : str
    'r0/knee', or 'knee' if there is only one robot.

Returns
-------
array (6)
    Force [N] and moment [N m] in the child frame, about its origin.

Raises
------
ValueError
    There is no such joint, or none of these functions was the last one called with the
    data.)";

// clang-format on

}  // namespace manycontact::python::doc
