#pragma once
// Docstrings of functions for frames and quantities of the whole, in the layout of numpydoc.

namespace manycontact::python::doc {

// clang-format off
inline constexpr const char* forward_kinematics =
    R"(Set the state of the data to q, v and a.

Parameters
----------
bodies : Scene, Model or RigidBodies
    All robots of a scene, a model at the origin, or a selection.
data : RigidBodyData
q : array (nq)
    Configuration [m, rad, unit quaternions].
v : array (nv), optional
    Velocity [m/s, rad/s]; zero if not given.
a : array (nv), optional
    Accelerations [m/s^2, rad/s^2]; zero if not given.

Raises
------
ValueError
    A size does not fit, or a number is not finite.)";

inline constexpr const char* frame_placement =
    R"(Return the placement of a frame at the state of the data.

Parameters
----------
bodies : Scene, Model or RigidBodies
    All robots of a scene, a model at the origin, or a selection.
data : RigidBodyData
frame : str or Attachment
    Frame by name: 'r0/sole', or 'sole' if there is only one robot.

Returns
-------
SE3
    Placement oMf in the world.

Raises
------
ValueError
    There is no such frame.)";

inline constexpr const char* frame_velocity =
    R"(Return the spatial velocity of a frame at the state of the data.

Parameters
----------
bodies : Scene, Model or RigidBodies
    All robots of a scene, a model at the origin, or a selection.
data : RigidBodyData
frame : str or Attachment
    Frame by name: 'r0/sole', or 'sole' if there is only one robot.
reference_frame : ReferenceFrame, optional
    LOCAL: the frame's axes, at its origin. WORLD: the world's axes, at the world's origin.
    LOCAL_WORLD_ALIGNED: the world's axes, at the frame's origin.

Returns
-------
array (6)
    Linear part first [m/s, rad/s].

Raises
------
ValueError
    There is no such frame.)";

inline constexpr const char* frame_acceleration =
    R"(Return the spatial acceleration of a frame at the state of the data.

Parameters
----------
bodies : Scene, Model or RigidBodies
    All robots of a scene, a model at the origin, or a selection.
data : RigidBodyData
frame : str or Attachment
    Frame by name: 'r0/sole', or 'sole' if there is only one robot.
reference_frame : ReferenceFrame, optional
    LOCAL: the frame's axes, at its origin. WORLD: the world's axes, at the world's origin.
    LOCAL_WORLD_ALIGNED: the world's axes, at the frame's origin.

Returns
-------
array (6)
    Linear part first [m/s^2, rad/s^2].

Raises
------
ValueError
    There is no such frame.)";

inline constexpr const char* frame_classical_acceleration =
    R"(Return the classical acceleration of a frame: the linear part is that of its origin as a point.

Parameters
----------
bodies : Scene, Model or RigidBodies
    All robots of a scene, a model at the origin, or a selection.
data : RigidBodyData
frame : str or Attachment
    Frame by name: 'r0/sole', or 'sole' if there is only one robot.
reference_frame : ReferenceFrame, optional
    LOCAL: the frame's axes, at its origin. WORLD: the world's axes, at the world's origin.
    LOCAL_WORLD_ALIGNED: the world's axes, at the frame's origin.

Returns
-------
array (6)
    Linear part first [m/s^2, rad/s^2].

Raises
------
ValueError
    There is no such frame.)";

inline constexpr const char* frame_drift =
    R"(Return the bias acceleration (dJ/dt) v of a frame at the state of the data.

The rate of frame_velocity is J a plus this vector.

Parameters
----------
bodies : Scene, Model or RigidBodies
    All robots of a scene, a model at the origin, or a selection.
data : RigidBodyData
frame : str or Attachment
    Frame by name: 'r0/sole', or 'sole' if there is only one robot.
reference_frame : ReferenceFrame, optional
    LOCAL: the frame's axes, at its origin. WORLD: the world's axes, at the world's origin.
    LOCAL_WORLD_ALIGNED: the world's axes, at the frame's origin.

Returns
-------
array (6)
    Linear part first [m/s^2, rad/s^2].

Raises
------
ValueError
    There is no such frame.)";

inline constexpr const char* frame_jacobian =
    R"(Return the Jacobian of a frame at the state of the data: frame_velocity = J v.

Parameters
----------
bodies : Scene, Model or RigidBodies
    All robots of a scene, a model at the origin, or a selection.
data : RigidBodyData
frame : str or Attachment
    Frame by name: 'r0/sole', or 'sole' if there is only one robot.
reference_frame : ReferenceFrame, optional
    LOCAL: the frame's axes, at its origin. WORLD: the world's axes, at the world's origin.
    LOCAL_WORLD_ALIGNED: the world's axes, at the frame's origin.

Returns
-------
array (6, nv)

Raises
------
ValueError
    There is no such frame.)";

inline constexpr const char* total_mass =
    R"(Return the mass of all moving bodies; bodies merged into a fixed base do not count.

Parameters
----------
bodies : Scene, Model or RigidBodies
    All robots of a scene, a model at the origin, or a selection.

Returns
-------
float
    [kg].)";

inline constexpr const char* center_of_mass =
    R"(Return the centre of mass at the state of the data.

Parameters
----------
bodies : Scene, Model or RigidBodies
    All robots of a scene, a model at the origin, or a selection.
data : RigidBodyData

Returns
-------
array (3)
    In the world [m].)";

inline constexpr const char* center_of_mass_velocity =
    R"(Return the velocity of the centre of mass at the state of the data.

Parameters
----------
bodies : Scene, Model or RigidBodies
    All robots of a scene, a model at the origin, or a selection.
data : RigidBodyData

Returns
-------
array (3)
    In the world [m/s].)";

inline constexpr const char* center_of_mass_acceleration =
    R"(Return the acceleration of the centre of mass at the state of the data.

Parameters
----------
bodies : Scene, Model or RigidBodies
    All robots of a scene, a model at the origin, or a selection.
data : RigidBodyData

Returns
-------
array (3)
    In the world [m/s^2].)";

inline constexpr const char* center_of_mass_jacobian =
    R"(Return the Jacobian of the centre of mass at the state of the data: its velocity is J v.

Parameters
----------
bodies : Scene, Model or RigidBodies
    All robots of a scene, a model at the origin, or a selection.
data : RigidBodyData

Returns
-------
array (3, nv))";

inline constexpr const char* centroidal_momentum =
    R"(Return the momentum about the centre of mass at the state of the data.

Parameters
----------
bodies : Scene, Model or RigidBodies
    All robots of a scene, a model at the origin, or a selection.
data : RigidBodyData

Returns
-------
array (6)
    In world axes: linear [N s], angular [N m s].)";

inline constexpr const char* centroidal_momentum_matrix =
    R"(Return the matrix A with centroidal_momentum = A v at the state of the data.

Parameters
----------
bodies : Scene, Model or RigidBodies
    All robots of a scene, a model at the origin, or a selection.
data : RigidBodyData

Returns
-------
array (6, nv))";

inline constexpr const char* centroidal_momentum_rate =
    R"(Return the rate of the momentum at the state of the data.

Parameters
----------
bodies : Scene, Model or RigidBodies
    All robots of a scene, a model at the origin, or a selection.
data : RigidBodyData

Returns
-------
array (6)
    In world axes [N, N m].)";

inline constexpr const char* kinetic_energy =
    R"(Return the kinetic energy at the state of the data, rotors included.

Parameters
----------
bodies : Scene, Model or RigidBodies
    All robots of a scene, a model at the origin, or a selection.
data : RigidBodyData

Returns
-------
float
    [J].)";

inline constexpr const char* potential_energy =
    R"(Return the potential energy at the state of the data, zero at the world's origin.

Parameters
----------
bodies : Scene, Model or RigidBodies
    All robots of a scene, a model at the origin, or a selection.
data : RigidBodyData

Returns
-------
float
    [J].)";

// clang-format on

}  // namespace manycontact::python::doc
