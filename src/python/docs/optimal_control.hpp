#pragma once
// Docstrings of functions for optimal control, in the layout of numpydoc.

namespace manycontact::python::doc {

// clang-format off
inline constexpr const char* contacts_of_scene =
    R"(Make a ContactModelMultiple of all contacts of a scene, with their names.

Parameters
----------
state : StateMultibody
scene : Scene
nu : int
    Number of controls.

Returns
-------
ContactModelMultiple

Raises
------
ValueError
    The state is not of the scene's robots.)";

inline constexpr const char* kkt_residual =
    R"(Compute the largest violation of the optimality conditions.

Parameters
----------
problem : ShootingProblem
xs : list of arrays
    T + 1 states.
us : list of arrays
    T controls.
multipliers : list of arrays
    T + 1 multipliers of the dynamics.
limits : bool
    Whether limits of controls are used.
constraint_multipliers : list of arrays, optional
    T + 1 multipliers of the constraints; empty: without constraints.
scale : float
    Unit of the cost, above 0: gradients and multipliers are divided by it.

Returns
-------
float
    Infinite if a number is not finite.

Raises
------
ValueError
    A size does not fit.)";

inline constexpr const char* read_task =
    R"(Read an optimal control task from its XML file.

Parameters
----------
path : str
    Path of the file.

Returns
-------
TaskFile

Raises
------
InputError
    "FILE:LINE: what is wrong and what was expected"; a ValueError.)";

inline constexpr const char* make_problem =
    R"(Make the shooting problem of a task, with its initial guess.

'sparse' and 'auto' divide it into decoupled subproblems. 'fddp' makes nodes of the whole scene,
which take hundreds of times the memory for many robots.

Parameters
----------
task : TaskFile
solver : TaskSolver, optional
    Solver that the nodes are made for; None: that of the task.

Returns
-------
TaskProblem

Raises
------
InputError
    A term does not fit the robots, or the nodes would not fit into memory; a ValueError.)";

inline constexpr const char* optimize =
    R"(Solve an optimal control task. Ctrl-C raises KeyboardInterrupt.

Parameters
----------
task : TaskFile
problem : TaskProblem, optional
    Result of make_problem with the same solver, for an initial guess of your own.
solver : TaskSolver, optional
    None: that of the task.
threads : int, optional
    Number of threads; 0: as many as OpenMP offers.
each : callable, optional
    Called with a TaskIteration after each iteration; if it returns False, the solve ends.

Returns
-------
TaskSolution
    converged and reason contain the outcome.

Raises
------
ValueError
    The problem does not fit the task.)";

inline constexpr const char* simulate_solution =
    R"(Simulate the solution of a task with its torques and feedback gains.

A contact that closes causes an impact.

Parameters
----------
task : TaskFile
solution : TaskSolution
integrator : Integrator, optional
substeps : int, optional
    Number of steps per node, at least 1.

Returns
-------
SimulatedMotion

Raises
------
ValueError
    The solution is of another task.)";

// clang-format on

}  // namespace manycontact::python::doc
