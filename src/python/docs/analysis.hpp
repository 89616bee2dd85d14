#pragma once
// Docstrings of functions for contacts and diagnostics, in the layout of numpydoc.

namespace manycontact::python::doc {

// clang-format off
inline constexpr const char* contact_jacobian =
    R"(Compute the Jacobian J of the active contacts: J a + a0 = 0, M a + h = S^T u + J^T f.

It computes the kinematics at each call.

Parameters
----------
scene : Scene
q : array (nq)
    Configuration [m, rad, unit quaternions].
active : sequence of bool, optional
    One flag per contact; by default those of the scene.

Returns
-------
array (rows, nv)
    Rows in the order of the scene's contacts, in each contact's reference frame.

Raises
------
ValueError
    A size does not fit the scene.)";

inline constexpr const char* contact_drift =
    R"(Compute the bias a0 of the active contacts: (dJ/dt) v plus the stabilisation terms.

Parameters
----------
scene : Scene
q : array (nq)
    Configuration [m, rad, unit quaternions].
v : array (nv)
    Velocity [m/s, rad/s].
active : sequence of bool, optional
    One flag per contact; by default those of the scene.

Returns
-------
array (rows)
    [m/s^2, rad/s^2], in the order of contact_jacobian.

Raises
------
ValueError
    A size does not fit the scene.)";

inline constexpr const char* forces_on_bodies =
    R"(Compute all external wrenches on bodies, for rnea's fext.

They are those of the contact forces and pushes of data, and of the springs between points.

Parameters
----------
scene : Scene
q : array (nq)
    Configuration [m, rad, unit quaternions].
v : array (nv)
    Velocity [m/s, rad/s].
data : SceneData
    Solved data.

Returns
-------
array (njoints, 6)
    Forces [N] and moments [N m] on the bodies, robot by robot, in the child frames.

Raises
------
ValueError
    A size does not fit the scene.
RuntimeError
    Nothing was solved.)";

inline constexpr const char* contact_forces_on_bodies =
    R"(Convert contact forces to wrenches on the bodies, for rnea's fext.

Parameters
----------
scene : Scene
q : array (nq)
    Configuration [m, rad, unit quaternions].
f : array (rows)
    SceneData.f.
f_offset : list of int
    SceneData.f_offset.

Returns
-------
array (njoints, 6)
    Wrenches in the joints' child frames [N, N m].

Raises
------
ValueError
    A size does not fit the scene.)";

inline constexpr const char* unique_forces =
    R"(Find the contact forces that are unique after a solve.

The others could be distributed differently among redundant contacts with the same
accelerations. data.f is then the choice of least norm, with moments weighted by
Scene.moment_length.

Parameters
----------
scene : Scene
q : array (nq)
    Configuration of the last solve.
data : SceneData

Returns
-------
array of bool (rows of f)

Raises
------
ValueError
    There is no solution.)";

inline constexpr const char* force_null_space =
    R"(Compute a basis N of the null space of J^T, after a solve.

All forces data.f + N @ y cause the same accelerations. For conditions such as friction cones, use
N in a quadratic programme for y.

Parameters
----------
scene : Scene
q : array (nq)
    Configuration of the last solve.
data : SceneData

Returns
-------
scipy.sparse.csc_matrix
    Orthonormal columns, one per redundant row, with the rows of data.f; block diagonal by island.

Raises
------
ValueError
    There is no solution, or a size does not fit.)";

inline constexpr const char* redistribute_forces =
    R"(Compute other contact forces with the same accelerations, after a solve.

They minimise sum(weights * (f - reference)**2) over all f with the same J^T f; data.f remains
unchanged. To move forces into friction cones, use a reference along the contacts' normals.

Parameters
----------
scene : Scene
q : array (nq)
    Configuration of the last solve.
data : SceneData
reference : array (rows of f), optional
    Forces to come close to [N, N m]; None: zero, which gives the least norm.
weights : array (rows of f), optional
    Weights above 0; None: ones.

Returns
-------
array (rows of f)
    Contact forces in each contact's reference frame [N, N m]; NaN for failed islands.

Raises
------
ValueError
    There is no solution, a size does not fit, or a number is not finite or not above 0.)";

inline constexpr const char* rank_gap =
    R"(Return how reliable the rank decision of an island was, after a solve.

Parameters
----------
scene : Scene
data : SceneData
island : int
    Number of the island.

Returns
-------
RankGap

Raises
------
ValueError
    There is no solution.)";

inline constexpr const char* near_dependent =
    R"(List islands with nearly dependent constraint rows, after a solve.

The component of such a row orthogonal to the preceding rows is below a thousandth of its norm.

Parameters
----------
scene : Scene
q : array (nq)
    Configuration of the last solve.
data : SceneData

Returns
-------
list of NearDependent

Raises
------
ValueError
    There is no solution.)";

inline constexpr const char* rank_changes =
    R"(List islands whose constraint rows are dependent here but not at neighbouring configurations, after a solve.

Derivatives do not exist there.

Parameters
----------
scene : Scene
q : array (nq)
    Configuration of the last solve.
data : SceneData

Returns
-------
list of RankChange

Raises
------
ValueError
    There is no solution.)";

inline constexpr const char* violations =
    R"(List forces that unilateral contacts with friction cannot exert, after a solve.

Parameters
----------
scene : Scene
q : array (nq)
    Configuration of the last solve.
data : SceneData

Returns
-------
list of Violation
    Active contacts with a mu that pull, slip, tip or turn.

Raises
------
ValueError
    There is no solution.)";

inline constexpr const char* limits_passed =
    R"(List coordinates that exceed the limits of the robots' files.

Parameters
----------
scene : Scene
q : array (nq)
    Configuration [m, rad, unit quaternions].
v : array (nv)
    Velocity [m/s, rad/s].
u : array (nu)
    Torques [N m, N].

Returns
-------
list of LimitPassed

Raises
------
ValueError
    A size does not fit the scene.)";

inline constexpr const char* placement_errors =
    R"(List contacts that are out of place by 1e-6 m or rad or more.

Parameters
----------
scene : Scene
q : array (nq)
    Configuration [m, rad, unit quaternions].
active : sequence of bool, optional
    One flag per contact; by default those of the scene.

Returns
-------
list of PlacementError

Raises
------
ValueError
    A size does not fit the scene.)";

inline constexpr const char* velocity_errors =
    R"(List contacts that move by 1e-6 m/s or rad/s or more; make_consistent corrects the state.

Parameters
----------
scene : Scene
q : array (nq)
    Configuration [m, rad, unit quaternions].
v : array (nv)
    Velocity [m/s, rad/s].
active : sequence of bool, optional
    One flag per contact; by default those of the scene.

Returns
-------
list of VelocityError

Raises
------
ValueError
    A size does not fit the scene.)";

// clang-format on

}  // namespace manycontact::python::doc
