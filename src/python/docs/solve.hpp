#pragma once
// Docstrings of functions for solves, contacts and diagnostics, in the layout of numpydoc.

namespace manycontact::python::doc {

// clang-format off
inline constexpr const char* solve =
    R"(Compute contact forward dynamics: the accelerations data.a and the contact forces data.f.

The solution satisfies, for each island,

    [ M  J^T     ] [  a ]   [ S^T u + J_F^T w + tau_s(q, v) - h ]
    [ J  -delta I] [ -f ] = [              -a0                  ]

where w are the wrenches data.pushes at the frames F of the scene's pushes, and tau_s are the
torques of springs and of joint friction. The method is data.options.method. Other Python
threads run meanwhile.

Parameters
----------
scene : Scene
q : array (nq)
    Configuration [m, rad; unit quaternions x, y, z, w].
v : array (nv)
    Velocity [m/s, rad/s]; of floating bases in their own frames, linear part first.
u : array (nu)
    Torques of the actuated coordinates [N m; N for prismatic joints].
data : SceneData
    Receives the solution. Use one per thread.

Returns
-------
Report
    Status, rank and residuals. Accelerations and forces of failed islands are NaN.

Raises
------
ValueError
    A size does not fit the scene, a number is not finite, or the data are of another scene.)";

inline constexpr const char* solve_tau =
    R"(Compute contact forward dynamics for torques on every velocity coordinate, floating bases included.

Parameters
----------
scene : Scene
q : array (nq)
    Configuration [m, rad, unit quaternions].
v : array (nv)
    Velocity [m/s, rad/s].
tau : array (nv)
    Torques [N m, N].
data : SceneData
    Receives the solution.

Returns
-------
Report
    As in solve.

Raises
------
ValueError
    A size does not fit the scene, a number is not finite, or the data are of another scene.)";

inline constexpr const char* prepare =
    R"(Find the islands for data.active and set up their systems.

solve calls this function. Call it to move the cost of the analysis before the first solve.

Parameters
----------
scene : Scene
data : SceneData

Raises
------
ValueError
    The data are of another scene.)";

inline constexpr const char* system_quality =
    R"(Compute backward errors, growth, condition and signature of each island's equations after a solve.

Parameters
----------
scene : Scene
data : SceneData

Returns
-------
list of SystemQuality

Raises
------
ValueError
    There is no solution.)";

inline constexpr const char* estimate_condition =
    R"(Estimate the 1-norm condition number of each island's K after a solve.

It takes a few solves with the existing factor.

Parameters
----------
scene : Scene
data : SceneData

Returns
-------
Report
    With condition set; also in data.report.

Raises
------
ValueError
    There is no solution.)";

inline constexpr const char* estimate_errors =
    R"(Bound the relative errors of each island's a and f after a solve.

It takes a few solves with the existing factor. If a bound is 1 or more, the status may become
'regularised'.

Parameters
----------
scene : Scene
data : SceneData

Returns
-------
Report
    With error_acceleration and error_forces set; also in data.report.

Raises
------
ValueError
    There is no solution.)";

inline constexpr const char* quasi_static =
    R"(Compute torques that keep the scene at rest.

They are the u part of the minimum-norm least-squares solution of [S^T J^T] [u; f] = h(q, 0).

Parameters
----------
scene : Scene
q : array (nq)
    Configuration [m, rad, unit quaternions].
data : SceneData, optional
    Its active contacts and pushes are used; derivatives need a new solve afterwards.

Returns
-------
array (nu)
    Torques [N m, N]; NaN for islands that cannot be computed.

Raises
------
ValueError
    q does not fit the scene.)";

inline constexpr const char* lanes_here =
    R"(List the SIMD instruction sets that this processor supports, widest first.

Returns
-------
list of Lanes)";

inline constexpr const char* force_names =
    R"(Return the names of the rows of data.f, such as 'left[0]'.

Parameters
----------
scene : Scene
data : SceneData

Returns
-------
list of str)";

inline constexpr const char* contact_force =
    R"(Return the force of a contact on A at the last solve.

Parameters
----------
scene : Scene
data : SceneData
contact : int or str
    Number or name of the contact.

Returns
-------
array (rows of the contact)
    Force in the contact's reference frame [N, N m]; a copy.

Raises
------
ValueError
    There is no such contact, it is not active, or there is no solution.)";

inline constexpr const char* island_count =
    R"(Return the number of islands.

Parameters
----------
data : SceneData

Returns
-------
int)";

inline constexpr const char* island_of =
    R"(Return the robots and contacts of an island.

Parameters
----------
data : SceneData
island : int
    Number of the island.

Returns
-------
Island
    A copy.

Raises
------
ValueError
    There is no such island.)";

inline constexpr const char* update_kinematics =
    R"(Compute placements and velocities of all robots, for frame_placement. It discards the solution.

Parameters
----------
scene : Scene
q : array (nq)
    Configuration [m, rad, unit quaternions].
v : array (nv)
    Velocity [m/s, rad/s].
data : SceneData

Raises
------
ValueError
    A size does not fit the scene.)";

inline constexpr const char* scene_frame_placement =
    R"(Return the placement of a robot's frame at the last solve or update_kinematics.

Parameters
----------
scene : Scene
data : SceneData
robot : str
    Name of the robot.
frame : str
    Name of the frame.

Returns
-------
SE3
    Placement oMf in the world.

Raises
------
ValueError
    There is no such robot or frame.)";

inline constexpr const char* complete =
    R"(Compute the intermediate results of robots that were solved in a SIMD batch.

Parameters
----------
scene : Scene
data : SceneData

Raises
------
ValueError
    There is no solution.)";

inline constexpr const char* matrix_of =
    R"(Return the KKT matrix K = [M J^T; J -delta I] of the last solve.

Parameters
----------
scene : Scene
data : SceneData
island : int, optional
    Number of an island, for its matrix in its own order; -1: the whole scene.

Returns
-------
scipy.sparse.csc_matrix
    Rows and columns are [a; f].

Raises
------
ValueError
    There is no solution, or no such island.)";

inline constexpr const char* solve_batch =
    R"(Solve many states of a scene.

A state's result is bitwise that of solve, for any number of threads. Ctrl-C interrupts between
some hundreds of states.

Parameters
----------
scene : Scene
Q : array (n, nq)
    Configurations, one per row.
V : array (n, nv)
    Velocities.
U : array (n, nu)
    Torques.
batch : BatchData
    Workspace; its active flags and pushes apply to all states.

Returns
-------
tuple (A, F, status)
    Accelerations (n, nv), forces (n, rows) and int8 (n) values of Status. Failed states are
    NaN.

Raises
------
ValueError
    A size does not fit the scene.)";

// clang-format on

}  // namespace manycontact::python::doc
