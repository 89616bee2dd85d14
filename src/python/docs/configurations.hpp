#pragma once
// Docstrings of functions for configurations and names, in the layout of numpydoc.

namespace manycontact::python::doc {

// clang-format off
inline constexpr const char* frame_names =
    R"(Return the names of all frames: 'r0/knee', or 'knee' if there is only one robot.

Parameters
----------
bodies : Scene, Model or RigidBodies
    All robots of a scene, a model at the origin, or a selection.

Returns
-------
list of str)";

inline constexpr const char* joint_names =
    R"(Return the names of all movable joints: 'r0/knee', or 'knee' if there is only one robot.

Parameters
----------
bodies : Scene, Model or RigidBodies
    All robots of a scene, a model at the origin, or a selection.

Returns
-------
list of str)";

inline constexpr const char* frame_called =
    R"(Find a frame by name.

Parameters
----------
bodies : Scene, Model or RigidBodies
    All robots of a scene, a model at the origin, or a selection.
name : str
    Link, or joint for the link behind it: 'r0/knee', or 'knee' if there is only one robot.

Returns
-------
Attachment

Raises
------
ValueError
    There is no such frame; the message suggests the nearest name.)";

inline constexpr const char* joint_called =
    R"(Find a joint by name.

Parameters
----------
bodies : Scene, Model or RigidBodies
    All robots of a scene, a model at the origin, or a selection.
name : str
    'r0/knee', or 'knee' if there is only one robot.

Returns
-------
tuple (int, int)
    Numbers of the robot in its scene and of the joint in its model.

Raises
------
ValueError
    There is no such joint; the message suggests the nearest name.)";

inline constexpr const char* neutral =
    R"(Return the configuration with all joints at zero and floating bases at Robot.base.

Parameters
----------
bodies : Scene, Model or RigidBodies
    All robots of a scene, a model at the origin, or a selection.

Returns
-------
array (nq))";

inline constexpr const char* random_configuration =
    R"(Sample a configuration within the joints' limits, with any orientation of floating bases.

Parameters
----------
bodies : Scene, Model or RigidBodies
    All robots of a scene, a model at the origin, or a selection.
seed : int

Returns
-------
array (nq))";

inline constexpr const char* random_velocity =
    R"(Sample a velocity within the joints' limits; without limits within +-1 m/s or rad/s.

Parameters
----------
bodies : Scene, Model or RigidBodies
    All robots of a scene, a model at the origin, or a selection.
seed : int

Returns
-------
array (nv))";

inline constexpr const char* integrate =
    R"(Compute q (+) v: the configuration reached from q with the constant velocity v in unit time.

Parameters
----------
bodies : Scene, Model or RigidBodies
    All robots of a scene, a model at the origin, or a selection.
q : array (nq)
    Configuration [m, rad, unit quaternions].
v : array (nv)
    Velocity [m/s, rad/s].

Returns
-------
array (nq)

Raises
------
ValueError
    A size does not fit.)";

inline constexpr const char* difference =
    R"(Compute q1 (-) q0: the velocity v with integrate(bodies, q0, v) = q1.

Parameters
----------
bodies : Scene, Model or RigidBodies
    All robots of a scene, a model at the origin, or a selection.
q0 : array (nq)
q1 : array (nq)

Returns
-------
array (nv)

Raises
------
ValueError
    A size does not fit.)";

inline constexpr const char* interpolate =
    R"(Compute q0 (+) share (q1 (-) q0).

Parameters
----------
bodies : Scene, Model or RigidBodies
    All robots of a scene, a model at the origin, or a selection.
q0 : array (nq)
q1 : array (nq)
share : float
    0 for q0, 1 for q1.

Returns
-------
array (nq)

Raises
------
ValueError
    A size does not fit.)";

inline constexpr const char* integrate_derivatives =
    R"(Compute the derivatives of q (+) v, on the tangent spaces at q and q (+) v.

Parameters
----------
bodies : Scene, Model or RigidBodies
    All robots of a scene, a model at the origin, or a selection.
q : array (nq)
    Configuration [m, rad, unit quaternions].
v : array (nv)
    Velocity [m/s, rad/s].

Returns
-------
tuple of arrays (nv, nv)
    With respect to q and v.

Raises
------
ValueError
    A size does not fit.)";

inline constexpr const char* difference_derivatives =
    R"(Compute the derivatives of q1 (-) q0, on the tangent spaces at q0 and q1.

Parameters
----------
bodies : Scene, Model or RigidBodies
    All robots of a scene, a model at the origin, or a selection.
q0 : array (nq)
q1 : array (nq)

Returns
-------
tuple of arrays (nv, nv)
    With respect to q0 and q1.

Raises
------
ValueError
    A size does not fit.)";

// clang-format on

}  // namespace manycontact::python::doc
