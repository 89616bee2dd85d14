#pragma once
// Docstrings of functions for inverse kinematics, in the layout of numpydoc.

namespace manycontact::python::doc {

// clang-format off
inline constexpr const char* pose_goal =
    R"(Make a goal for the placement of a frame in the world.

Give a placement, or components of position and rpy. position=(None, None, 0) requires z = 0
only; rpy=(0, 0, None) makes the frame's z point up.

Parameters
----------
scene : Scene
frame : str or Attachment
    Such as 'r/sole'.
placement : SE3, optional
    Complete placement.
position : sequence, optional
    x, y, z [m], or None for an open component.
rpy : sequence, optional
    Rotations about the world's x, then y, then z [rad], or None for an open angle.
weight : float, optional
    Weight against other goals.

Returns
-------
Goal

Raises
------
ValueError
    There is no such frame, or a number does not fit.)";

inline constexpr const char* center_of_mass_goal =
    R"(Make a goal for the centre of mass of the scene or of a robot.

Parameters
----------
scene : Scene
position : sequence
    x, y, z [m], or None for an open component.
robot : str, optional
    Name of the robot; '' for the whole scene.
weight : float, optional
    Weight against other goals.

Returns
-------
Goal

Raises
------
ValueError
    There is no such robot, or a number does not fit.)";

inline constexpr const char* joint_goal =
    R"(Make a goal for the position of a joint with one coordinate.

Parameters
----------
scene : Scene
joint : str
    Such as 'r/knee'.
value : float
    Position [rad, m].
weight : float, optional
    Weight against other goals.

Returns
-------
Goal

Raises
------
ValueError
    There is no such joint, or a number does not fit.)";

inline constexpr const char* contact_goal =
    R"(Make a goal for a contact, active or not: that it is in place.

Parameters
----------
scene : Scene
contact : str
    Name of the contact.
weight : float, optional
    Weight against other goals.

Returns
-------
Goal

Raises
------
ValueError
    There is no such contact, or a number does not fit.)";

inline constexpr const char* place =
    R"(Solve inverse kinematics: find a configuration that meets goals, within the joints' limits.

It makes damped Gauss-Newton steps from q and finds a local minimum. The errors of contradicting
goals are distributed according to their weights.

Parameters
----------
scene : Scene
q : array (nq)
    Start of the search.
goals : list of Goal
iterations : int, optional
    Largest number of steps from each start.
tolerance : float, optional
    Largest error of a goal that is met [m, rad].
restarts : int, optional
    Number of further starts from random joint positions, while goals are not met.
seed : int, optional
    Seed of the random starts.

Returns
-------
PlacedScene
    The configuration, which is within the limits, and the remaining error of each goal.

Raises
------
ValueError
    A size, number, robot, joint or contact does not fit.)";

inline constexpr const char* make_consistent =
    R"(Find a state near q, v in which contacts are in place and do not move.

It makes Gauss-Newton steps of least change in the mass-weighted norm for q, and one projection
for v.

Parameters
----------
scene : Scene
q : array (nq)
    Configuration [m, rad, unit quaternions].
v : array (nv)
    Velocity [m/s, rad/s].
active : sequence of bool, optional
    One flag per contact; by default those of the scene.
options : Options, optional
    Options of the solves.

Returns
-------
ConsistentState
    The state, and the contacts that could not be corrected.

Raises
------
ValueError
    A size does not fit the scene.)";

// clang-format on

}  // namespace manycontact::python::doc
