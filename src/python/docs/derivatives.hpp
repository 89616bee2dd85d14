#pragma once
// Docstrings of functions for derivatives, in the layout of numpydoc.

namespace manycontact::python::doc {

// clang-format off
inline constexpr const char* differentiate =
    R"(Compute the derivatives of data.a and data.f at the last solve, as blocks per island.

While the dynamics are differentiated, f is constant in each contact's own frame; q is on the
tangent space. If contacts are redundant, dforces_* are the derivatives of the least-norm
forces. Blocks of failed islands are NaN.

    mc.differentiate(scene, data).islands[0].da_dq       # (nv, nv) of island 0

Parameters
----------
scene : Scene
data : SceneData
request : DerivativeRequest, optional
    What to differentiate with respect to.

Returns
-------
DerivativeData

Raises
------
ValueError
    There is no solution, contacts were switched after it, or the data are of another scene.)";

inline constexpr const char* dense_derivatives =
    R"(Return the last derivatives as dense matrices of the whole scene.

The matrices have (nv + rows)(2 nv + nu) numbers. For large scenes use sparse_derivatives.

Parameters
----------
scene : Scene
data : SceneData

Returns
-------
SceneDerivatives

Raises
------
ValueError
    differentiate was not called after the last solve.)";

inline constexpr const char* sparse_derivatives =
    R"(Return the last derivatives as one sparse matrix of the whole scene.

Parameters
----------
scene : Scene
data : SceneData

Returns
-------
scipy.sparse.csc_matrix
    Rows [a; f], columns [q | v | u | w], as far as requested.

Raises
------
ValueError
    differentiate was not called after the last solve.)";

inline constexpr const char* release_derivatives =
    R"(Free the memory of the derivatives.

Parameters
----------
data : SceneData)";

inline constexpr const char* estimate_derivative_errors =
    R"(Bound the relative errors of each island's derivatives after differentiate, with a few solves.

Parameters
----------
scene : Scene
data : SceneData

Returns
-------
list of DerivativeBounds

Raises
------
ValueError
    differentiate was not called after the last solve.)";

inline constexpr const char* jvp =
    R"(Multiply the derivatives at the last solve by a direction, without forming them.

Parameters
----------
scene : Scene
data : SceneData
dq : array (nv)
    Direction on the tangent space.
dv : array (nv)
du : array (nu)
dw : array (6 per push), optional

Returns
-------
tuple (da, df)
    Changes of the accelerations (nv) and forces (rows of f).

Raises
------
ValueError
    A size does not fit, or there is no solution.)";

inline constexpr const char* vjp =
    R"(Multiply the transposed derivatives at the last solve by a vector, without forming them.

Parameters
----------
scene : Scene
data : SceneData
wa : array (nv)
    Weights of the accelerations.
wf : array (rows of f)
    Weights of the forces.

Returns
-------
tuple (wq, wv, wu)
    Gradients with respect to q (nv), v (nv) and u (nu).

Raises
------
ValueError
    A size does not fit, or there is no solution.)";

inline constexpr const char* vjp_with_pushes =
    R"(Multiply the transposed derivatives at the last solve by a vector, wrenches of pushes included.

Parameters
----------
scene : Scene
data : SceneData
wa : array (nv)
    Weights of the accelerations.
wf : array (rows of f)
    Weights of the forces.

Returns
-------
tuple (wq, wv, wu, ww)
    Gradients with respect to q, v, u and the wrenches (6 per push).

Raises
------
ValueError
    A size does not fit, or there is no solution.)";

inline constexpr const char* differentiate_batch =
    R"(Solve and differentiate many states of a scene.

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
tuple (A, F, D, status)
    As in solve_batch, and D (n, nv + rows, 2 nv + nu), the derivatives of [a; f] with
    respect to [q v u].

Raises
------
ValueError
    A size does not fit the scene.)";

inline constexpr const char* vjp_batch =
    R"(Solve many states of a scene and multiply the transposed derivatives by vectors.

Parameters
----------
scene : Scene
Q : array (n, nq)
    Configurations, one per row.
V : array (n, nv)
    Velocities.
U : array (n, nu)
    Torques.
WA : array (n, nv)
    Weights of the accelerations.
WF : array (n, rows)
    Weights of the forces.
batch : BatchData
    Workspace; its active flags and pushes apply to all states.

Returns
-------
tuple (WQ, WV, WU, status)
    Gradients (n, nv), (n, nv), (n, nu), and status as in solve_batch.

Raises
------
ValueError
    A size does not fit the scene.)";

inline constexpr const char* vjp_batch_with_pushes =
    R"(Compute vjp_batch, wrenches of pushes included.

Parameters
----------
scene : Scene
Q : array (n, nq)
    Configurations, one per row.
V : array (n, nv)
    Velocities.
U : array (n, nu)
    Torques.
WA : array (n, nv)
    Weights of the accelerations.
WF : array (n, rows)
    Weights of the forces.
batch : BatchData
    Workspace; its active flags and pushes apply to all states.

Returns
-------
tuple (WQ, WV, WU, WW, status)
    As in vjp_batch, and WW (n, 6 per push).

Raises
------
ValueError
    A size does not fit the scene.)";

// clang-format on

}  // namespace manycontact::python::doc
