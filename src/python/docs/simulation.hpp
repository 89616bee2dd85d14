#pragma once
// Docstrings of functions for simulation, in the layout of numpydoc.

namespace manycontact::python::doc {

// clang-format off
inline constexpr const char* step =
    R"(Make one step of a simulation.

Parameters
----------
scene : Scene
u : array (nu)
    Torques [N m, N].
data : SimulationData
    Advanced by one step; unchanged if the status is not OK.

Returns
-------
StepStatus
    If it is not OK, failure() describes the cause.

Raises
------
ValueError
    A size does not fit the scene, or a number is not finite.)";

inline constexpr const char* simulate =
    R"(Make steps from the state of the data, until one is not OK. Ctrl-C ends the simulation.

Parameters
----------
scene : Scene
u : array (nu) or (steps, nu)
    Torques [N m, N].
data : SimulationData
    Advanced.
steps : int
    Number of steps.
every : int, optional
    Number of steps between recorded states.

Returns
-------
Trajectory
    The initial state, every `every`-th state, and the last.

Raises
------
ValueError
    A size does not fit the scene, or a number is not finite.)";

inline constexpr const char* simulation_batch =
    R"(Many simulations of one scene, one per row, that step_batch steps together in SIMD batches and threads.

Each moves as by step alone, up to rounding errors. active, velocity_limit, kp and kd apply to all.)";

inline constexpr const char* set_state =
    R"(Continue one simulation of a batch from another state; the others do not change.

Parameters
----------
scene : Scene
k : int
    Number of the simulation.
q : array (nq)
    Configuration [rad, m].
v : array (nv)
    Velocities [rad/s, m/s].
batch : SimulationBatch
    Changed.

Raises
------
ValueError
    A size or the number does not fit, or a number is not finite.)";

inline constexpr const char* step_batch =
    R"(Make steps of all simulations of a batch. Ctrl-C ends them between two steps.

Parameters
----------
scene : Scene
u : array (states, nu)
    Torques of each state, the same in all steps [N m, N].
batch : SimulationBatch
    Advanced. A state whose step is not OK is unchanged by it; the others go on.
steps : int, optional
    Number of steps.

Returns
-------
array (states) of int8
    StepStatus of each state; if a step was not OK, that of the last such step.

Raises
------
ValueError
    A size does not fit the scene, or a number is not finite.)";

inline constexpr const char* step_contact_force =
    R"(Return the force of a contact on A in the last step.

Parameters
----------
scene : Scene
data : SimulationData
contact : int or str
    Number or name of the contact.

Returns
-------
array (rows of the contact)
    Force in the contact's reference frame [N, N m]; a copy.

Raises
------
ValueError
    There is no such contact, it was not active, or there was no step.)";

inline constexpr const char* failure =
    R"(Describe why a step was not OK.

Parameters
----------
scene : Scene
data : SimulationData
status : StepStatus

Returns
-------
str)";

inline constexpr const char* switch_contacts =
    R"(Switch contacts between steps.

If a contact closes, data.v becomes the nearest velocity that the contacts allow, in the
mass-weighted norm: an impact without restitution.

Parameters
----------
scene : Scene
active : sequence of bool
    One flag per contact.
data : SimulationData
    Changed.
here : bool
    Whether a contact that closes does so where its frame A is now: B of scene.contacts moves there.
    Without it, frame A has to be near B, or gains pull it there.

Returns
-------
VelocityJump

Raises
------
ValueError
    The number of flags does not fit the scene.)";

inline constexpr const char* invariants =
    R"(Compute constraint errors, energy and momentum of a state.

Parameters
----------
scene : Scene
active : sequence of bool
    One flag per contact.
q : array (nq)
    Configuration [m, rad, unit quaternions].
v : array (nv)
    Velocity [m/s, rad/s].

Returns
-------
Invariants

Raises
------
ValueError
    A size does not fit the scene.)";

inline constexpr const char* recommended_gains =
    R"(Return the recommended stabilisation gains of contacts for a step size.

Parameters
----------
integrator : Integrator
h : float
    Step size [s].

Returns
-------
Gains

Raises
------
ValueError
    h is not finite and positive.)";

inline constexpr const char* error_growth =
    R"(Return the factor by which a contact's error is multiplied per step.

Parameters
----------
integrator : Integrator
gains : Gains
h : float
    Step size [s].

Returns
-------
float)";

inline constexpr const char* largest_stable_step =
    R"(Return the largest step size for which contact errors do not grow.

Parameters
----------
integrator : Integrator
gains : Gains

Returns
-------
float
    [s]; infinite without gains.)";

// clang-format on

}  // namespace manycontact::python::doc
