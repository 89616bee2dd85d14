#pragma once
// Docstrings of functions for scenes, robots and files, in the layout of numpydoc.

namespace manycontact::python::doc {

// clang-format off
inline constexpr const char* add_robot =
    R"(Append a robot to a scene.

Existing data of the scene become invalid.

Parameters
----------
scene : Scene
name : str
    Name of the robot, unique in the scene.
model : Model
    Kinematic tree; copies of a robot may share it.
base : SE3, optional
    Placement of a fixed base in the world, or of a floating base in neutral(scene).

Returns
-------
int
    Number of the robot.

Raises
------
ValueError
    The name is used already, or the base is not finite.)";

inline constexpr const char* attach =
    R"(Make the attachment of a robot's frame.

Parameters
----------
scene : Scene
robot : str
    Name of the robot.
frame : str
    Name of the frame, such as a link.
offset : SE3, optional
    Placement relative to the frame.

Returns
-------
Attachment

Raises
------
ValueError
    There is no such robot or frame; the message suggests the nearest name.)";

inline constexpr const char* add_contact =
    R"(Append a contact to a scene.

The axis is normalised. If the body of B' cannot move, B' is expressed in the world. Existing
data of the scene become invalid.

Parameters
----------
scene : Scene
contact : Contact

Returns
-------
int
    Number of the contact.

Raises
------
ValueError
    A robot, joint or number does not fit, or the name is used already.)";

inline constexpr const char* add_push =
    R"(Append a push, an external wrench, to a scene.

Existing data of the scene become invalid.

Parameters
----------
scene : Scene
push : Push

Returns
-------
int
    Number of the push.

Raises
------
ValueError
    A robot, joint or number does not fit, or the name is used already.)";

inline constexpr const char* add_spring =
    R"(Append a spring between two points to a scene.

Existing data of the scene become invalid.

Parameters
----------
scene : Scene
spring : Spring

Returns
-------
int
    Number of the spring.

Raises
------
ValueError
    A robot, joint or number does not fit, or the name is used already.)";

inline constexpr const char* add_joint_spring =
    R"(Append a spring in a joint with one coordinate, with the torque -stiffness (q - rest).

Existing data of the scene become invalid.

Parameters
----------
scene : Scene
robot : str
    Name of the robot.
joint : str
    Name of the joint.
stiffness : float
    Not negative [N m/rad, N/m].
rest : float, optional
    Position without torque [rad, m].

Returns
-------
int
    Number of the spring.

Raises
------
ValueError
    There is no such joint, or a number does not fit.)";

inline constexpr const char* configuration_names =
    R"(Return the names of the coordinates of q, such as 'r0/knee' or 'r0/root[0]'.

Parameters
----------
scene : Scene

Returns
-------
list of str (nq))";

inline constexpr const char* velocity_names =
    R"(Return the names of the coordinates of v, such as 'r0/knee' or 'r0/root[0]'.

Parameters
----------
scene : Scene

Returns
-------
list of str (nv))";

inline constexpr const char* torque_names =
    R"(Return the names of the coordinates of u, such as 'r0/knee'.

Parameters
----------
scene : Scene

Returns
-------
list of str (nu))";

inline constexpr const char* push_names =
    R"(Return the names of the components of all wrenches: 'wind[0]' ... 'wind[5]' for each push.

Parameters
----------
scene : Scene

Returns
-------
list of str (6 per push))";

inline constexpr const char* q_index =
    R"(Return the first coordinate of a joint in q.

Parameters
----------
scene : Scene
robot : str
    Name of the robot.
joint : str
    Name of the joint.

Returns
-------
int

Raises
------
ValueError
    There is no such joint; the message suggests the nearest name.)";

inline constexpr const char* v_index =
    R"(Return the first coordinate of a joint in v.

Parameters
----------
scene : Scene
robot : str
    Name of the robot.
joint : str
    Name of the joint.

Returns
-------
int

Raises
------
ValueError
    There is no such joint; the message suggests the nearest name.)";

inline constexpr const char* u_index =
    R"(Return the first torque of a joint in u.

Parameters
----------
scene : Scene
robot : str
    Name of the robot.
joint : str
    Name of the joint.

Returns
-------
int

Raises
------
ValueError
    There is no such joint, or it has no torque.)";

inline constexpr const char* resolve_references =
    R"(Set the reference placement of every contact, so that all errors are zero at q.

Parameters
----------
scene : Scene
    Changed: B' of every contact is moved to the placement of A.
q : array (nq)
    Configuration [m, rad, unit quaternions].

Raises
------
ValueError
    q does not fit the scene.)";

inline constexpr const char* load_scene =
    R"(Load a scene from its XML file, with configuration, velocity and torques.

Parameters
----------
path : str
    Path of the file.

Returns
-------
SceneFile

Raises
------
InputError
    "FILE:LINE: what is wrong and what was expected"; a ValueError.)";

inline constexpr const char* load_scene_text =
    R"(Load a scene from XML text.

Parameters
----------
text : str
    The XML.
path : str, optional
    File that the text is treated as; paths of URDF files are relative to it.

Returns
-------
SceneFile

Raises
------
InputError
    "FILE:LINE: what is wrong and what was expected"; a ValueError.)";

inline constexpr const char* load_urdf =
    R"(Load a robot from a URDF file.

Fixed joints are merged. Joints are numbered depth first, those of a link in byte order of their
names. Questionable but usable input is accepted; urdf_findings lists it.

Parameters
----------
path : str
    Path of the file.
floating_base : bool, optional
    Whether joint 0 is a floating base, 'root', that moves the root link.
armature : float, optional
    Reflected rotor inertia of every joint [kg m^2; kg for prismatic joints].
joint_armature : dict, optional
    {joint: [numbers]}, overrides armature.
locked : dict, optional
    {joint: position}, freezes joints [rad, m].
refuse_mimic : bool, optional
    Whether a joint with <mimic> is an error.
passive : set of str, optional
    Joints without torques.
model_dynamics : bool, optional
    Whether the URDF's damping and friction of joints are modelled.
refuse_inertia : bool, optional
    Whether principal moments that violate the triangle inequality are an error.
actuated : set of str, optional
    Floating joints of the file with torques; by default they have none.
joint_damping : dict, optional
    {joint: damping}, overrides the URDF's [N m s/rad, N s/m].
root : str, optional
    Link that replaces the file's root. Joints between the two are inverted.

Returns
-------
Model

Raises
------
InputError
    Nothing can be computed from the file; a ValueError.
ValueError
    An option does not fit the robot.)";

inline constexpr const char* urdf_findings =
    R"(List questionable but usable input in a URDF file.

Parameters
----------
path : str
    Path of the file.
floating_base : bool, optional
    As in load_urdf.

Returns
-------
list of Finding
    In the order of lines.

Raises
------
InputError
    Nothing can be computed from the file; a ValueError.)";

// clang-format on

}  // namespace manycontact::python::doc
