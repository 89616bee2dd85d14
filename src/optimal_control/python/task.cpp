// Motions of task files.

#include "action.hpp"
#include "docs/optimal_control.hpp"
#include "manycontact/analysis/load_scene.hpp"
#include "manycontact/task/simulate.hpp"

namespace manycontact::python {

namespace {

// solver: none, the task's own. each: called with the TaskIteration after each iteration; False ends the solve, None
// does not.
TaskSolution optimize_task(const TaskFile& task, const std::shared_ptr<TaskProblem>& given,
                           std::optional<TaskSolver> solver, int threads, const std::optional<py::function>& each) {
  TaskOptions options;
  options.solver = solver;
  options.threads = checked_threads(threads);
  options.each = [&each](const TaskIteration& iteration) {
    const py::gil_scoped_acquire gil;
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
    if (!each) return true;
    const py::object answer = (*each)(iteration);
    return answer.is_none() || answer.cast<bool>();
  };
  const py::gil_scoped_release unlocked;
  if (given) return optimize(task, *given, options);
  TaskProblem problem = make_problem(task, options.solver.value_or(task.solver));
  return optimize(task, problem, options);
}

void add_simulated_motion(py::module_& m) {
  py::class_<SimulatedMotion> motion(m, "SimulatedMotion",
                                     "The simulated motion of a solution, and its distance from it.");
  add_value(motion)
      .def_readonly("stopped", &SimulatedMotion::stopped, "StepStatus: OK, or why the simulation ended early.")
      .def_readonly("xs", &SimulatedMotion::xs, "States at the nodes; at closing contacts before their impact.")
      .def_readonly("energy_lost", &SimulatedMotion::energy_lost, "Energy lost in impacts [J].")
      .def_readonly("position_drift", &SimulatedMotion::position_drift,
                    "Largest placement error of the active contacts [m, rad].")
      .def_readonly("velocity_drift", &SimulatedMotion::velocity_drift,
                    "Largest velocity of the active contacts [m/s, rad/s].")
      .def_readonly("distance", &SimulatedMotion::distance,
                    "Largest component of x (-) xs at any node, where xs is the solution.");
  m.def(
      "simulate",
      [](const TaskFile& task, const TaskSolution& solution, Integrator integrator, int substeps) {
        return manycontact::simulate(task, solution, integrator, substeps);
      },
      py::arg("task"), py::arg("solution"), py::arg_v("integrator", Integrator::kRk4, "'rk4'"),
      py::arg("substeps") = 10, Unlocked(), doc::simulate_solution);
}

void add_task_files(py::module_& m) {
  add_enumeration<TaskSolver>(m, "TaskSolver", "solver", "The solver of a task.",
                              {{"FDDP", TaskSolver::kFddp},
                               {"BOX_FDDP", TaskSolver::kBoxFddp},
                               {"SPARSE", TaskSolver::kSparse},
                               {"AUTO", TaskSolver::kAuto}});
  py::class_<TaskFile, std::shared_ptr<TaskFile>> task(m, "TaskFile", "An optimal control task from its file.");
  add_value(task)
      .def_readonly("path", &TaskFile::path, "Path of the file.")
      .def_readonly("name", &TaskFile::name, "Name of the task.")
      .def_property_readonly(
          "scene", [](const std::shared_ptr<TaskFile>& t) { return std::shared_ptr<SceneFile>(t, &t->scene); },
          "SceneFile.")
      .def_readonly("step", &TaskFile::step, "Time step [s].")
      .def_readwrite("solver", &TaskFile::solver, "TaskSolver that optimize and make_problem use.")
      .def_readwrite("iterations", &TaskFile::iterations, "Largest number of iterations.")
      .def_readwrite("tolerance", &TaskFile::tolerance, "Tolerance of the stopping value.")
      .def_property_readonly("nodes", &TaskFile::nodes, "Number of running nodes.");
  py::class_<TaskProblem, std::shared_ptr<TaskProblem>>(m, "TaskProblem", "The shooting problem of a task.")
      .def_readonly("state", &TaskProblem::state, "StateMultibody.")
      .def_readonly("actuation", &TaskProblem::actuation, "ActuationModelAbstract.")
      .def_readonly("models", &TaskProblem::models,
                    "Differential models, one per phase, then that of the terminal node.")
      .def_readonly("problem", &TaskProblem::problem, "ShootingProblem.")
      .def_readwrite("xs", &TaskProblem::xs, "Initial guess of the states; a copy: assign a list.")
      .def_readwrite("us", &TaskProblem::us, "Initial guess of the controls; a copy: assign a list.")
      .def_readwrite(
          "multipliers", &TaskProblem::multipliers,
          "Initial guess of the constraints' multipliers, as in TaskSolution.multipliers; empty: zeros. A copy:\n"
          "assign a list.")
      .def_readonly("parts", &TaskProblem::parts, "Robots of each decoupled subproblem.")
      .def_readonly("blocks", &TaskProblem::blocks, "Subproblems, divided at their couplings.");
}

void add_task_solutions(py::module_& m) {
  py::class_<TaskIteration> iteration(m, "TaskIteration", "The values of one iteration of a solver.");
  add_value(iteration)
      .def_readonly("cost", &TaskIteration::cost, "Cost of the task.")
      .def_readonly("stop", &TaskIteration::stop, "Stopping value.")
      .def_readonly("regularisation", &TaskIteration::regularisation, "Regularisation.")
      .def_readonly("step_length", &TaskIteration::step_length, "Length of the step.")
      .def_readonly("gaps", &TaskIteration::gaps, "Norm of the gaps before the step.")
      .def_readonly("feasible", &TaskIteration::feasible, "Whether there are no gaps after the step.");
  py::class_<TaskViolation> violation(m, "TaskViolation", "The violation of a constraint.");
  add_value(violation)
      .def_readonly("constraint", &TaskViolation::constraint, "Name of the constraint.")
      .def_readonly("by", &TaskViolation::by, "Largest distance of a row from its bounds.")
      .def_readonly("node", &TaskViolation::node, "Number of the node with the largest distance.");
  py::class_<TaskGains> gains(m, "TaskGains", "Feedback u = us[t] - K[t] (x (-) xs[t]) of robots solved together.");
  add_value(gains)
      .def_readonly("dx", &TaskGains::dx, "Indices of their coordinates in dx.")
      .def_readonly("u", &TaskGains::u, "Indices of their torques in u.")
      .def_readonly("K", &TaskGains::K, "Gain of each node (len(u), len(dx)), without rows at an impact; copies.");
  py::class_<TaskTimes> times(m, "TaskTimes", "Times per running node, medians over the iterations [us]; total [us].");
  add_value(times)
      .def_readonly("calc", &TaskTimes::calc, "Time of a forward pass per node [us].")
      .def_readonly("calc_diff", &TaskTimes::calc_diff, "Time of derivatives per node [us].")
      .def_readonly("direction", &TaskTimes::direction, "Time of a backward pass per node [us].")
      .def_readonly("total", &TaskTimes::total, "Total time [us].");
  py::class_<TaskSolution> solution(m, "TaskSolution", "The result of optimize.");
  add_value(solution)
      .def_readonly("converged", &TaskSolution::converged, "Whether all criteria of convergence are met.")
      .def_readonly("cost", &TaskSolution::cost, "Cost of the motion.")
      .def_readonly("reason", &TaskSolution::reason, "Why the solver stopped, with the remarks.")
      .def_readonly("remarks", &TaskSolution::remarks, "Remedies that were applied where a solver's own rule failed.")
      .def_readonly("multipliers", &TaskSolution::multipliers, "Multipliers of the constraints [g; h] of each node.")
      .def_readonly("iterations", &TaskSolution::iterations, "List of TaskIteration.")
      .def_readonly("polishing_iterations", &TaskSolution::polishing_iterations,
                    "Further iterations, until the KKT residual is small.")
      .def_readonly("xs", &TaskSolution::xs, "States (nq + nv) of the motion, nodes + 1.")
      .def_readonly("us", &TaskSolution::us, "Torques (nu) of each node [N m, N]; empty at an impact.")
      .def_readonly("gains", &TaskSolution::gains, "List of TaskGains; empty where the solver has none.")
      .def_readonly("solver", &TaskSolution::solver, "Name of the solver.")
      .def_readonly("direction", &TaskSolution::direction, "Method of search directions.")
      .def_readonly("blocks", &TaskSolution::blocks,
                    "Sizes of the matrices factorized at a node, one per subproblem or cluster.")
      .def_readonly("times", &TaskSolution::times, "TaskTimes")
      .def_readonly("kkt_residual", &TaskSolution::kkt_residual, "KKT residual.")
      .def_readonly("constraint_violation", &TaskSolution::constraint_violation, "Largest violation of a constraint.")
      .def_readonly("violations", &TaskSolution::violations, "List of TaskViolation.")
      .def_readonly("outer_iterations", &TaskSolution::outer_iterations,
                    "Number of minimisations of the augmented Lagrangian; 0 without constraints.");
}

}  // namespace

void add_task(py::module_& m) {
  add_task_files(m);
  add_task_solutions(m);
  m.def(
      "read_task",
      [](const std::string& path) {
        const auto task = std::make_shared<TaskFile>(read_task(path));
        fit_state(*task);
        return task;
      },
      py::arg("path"), Unlocked(), doc::read_task);
  m.attr("load_task") = m.attr("read_task");
  m.def(
      "make_problem",
      [](const TaskFile& task, std::optional<TaskSolver> solver) {
        return std::make_shared<TaskProblem>(make_problem(task, solver.value_or(task.solver)));
      },
      py::arg("task"), py::arg("solver") = py::none(), Unlocked(), doc::make_problem);
  m.def("optimize", &optimize_task, py::arg("task"), py::arg("problem") = py::none(), py::arg("solver") = py::none(),
        py::arg("threads") = 0, py::arg("each") = py::none(), doc::optimize);
  add_simulated_motion(m);
}

}  // namespace manycontact::python
