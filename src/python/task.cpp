// Motions of task files: floor task.

#include "action.hpp"
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
  py::class_<SimulatedMotion> motion(m, "SimulatedMotion", "Where a simulation of a solution went.");
  add_value(motion)
      .def_readonly("stopped", &SimulatedMotion::stopped, "StepStatus; anything but kOk: it ended there.")
      .def_readonly("xs", &SimulatedMotion::xs, "States at the nodes; where contacts close, before their impact.")
      .def_readonly("energy_lost", &SimulatedMotion::energy_lost, "By impacts [J].")
      .def_readonly("position_drift", &SimulatedMotion::position_drift, "Largest of the active contacts [m, rad].")
      .def_readonly("velocity_drift", &SimulatedMotion::velocity_drift, "[m/s, rad/s]")
      .def_readonly("distance", &SimulatedMotion::distance, "Largest component of x (-) xs at any node.");
  m.def(
      "simulate",
      [](const TaskFile& task, const TaskSolution& solution, Integrator integrator, int substeps) {
        return manycontact::simulate(task, solution, integrator, substeps);
      },
      py::arg("task"), py::arg("solution"), py::arg_v("integrator", Integrator::kRk4, "'rk4'"),
      py::arg("substeps") = 10, Unlocked(),
      "Follows a task's solution by its torques and gains, with `substeps` steps to a node and an impact where a\n"
      "contact closes; returns a SimulatedMotion.");
}

void add_task_files(py::module_& m) {
  add_enumeration<TaskSolver>(m, "TaskSolver", "solver", "How a task is solved.",
                              {{"FDDP", TaskSolver::kFddp},
                               {"BOX_FDDP", TaskSolver::kBoxFddp},
                               {"SPARSE", TaskSolver::kSparse},
                               {"AUTO", TaskSolver::kAuto}});
  py::class_<TaskFile, std::shared_ptr<TaskFile>> task(m, "TaskFile", "An optimal control task from its file.");
  add_value(task)
      .def_readonly("path", &TaskFile::path)
      .def_readonly("name", &TaskFile::name)
      .def_property_readonly(
          "scene", [](const std::shared_ptr<TaskFile>& t) { return std::shared_ptr<SceneFile>(t, &t->scene); },
          "SceneFile")
      .def_readonly("step", &TaskFile::step, "[s]")
      .def_readwrite("solver", &TaskFile::solver, "TaskSolver: what optimize and make_problem take.")
      .def_readwrite("iterations", &TaskFile::iterations)
      .def_readwrite("tolerance", &TaskFile::tolerance)
      .def_property_readonly("nodes", &TaskFile::nodes, "Running ones.");
  py::class_<TaskProblem, std::shared_ptr<TaskProblem>>(m, "TaskProblem", "The shooting problem of a task.")
      .def_readonly("state", &TaskProblem::state)
      .def_readonly("actuation", &TaskProblem::actuation)
      .def_readonly("models", &TaskProblem::models, "Per phase, then the terminal node.")
      .def_readonly("problem", &TaskProblem::problem, "ShootingProblem")
      .def_readwrite("xs", &TaskProblem::xs, "Initial guess; a copy: assign.")
      .def_readwrite("us", &TaskProblem::us)
      .def_readwrite("multipliers", &TaskProblem::multipliers,
                     "Guess of the constraints', as TaskSolution.multipliers; none: zeros. A copy: assign.")
      .def_readonly("parts", &TaskProblem::parts, "Robots of each part of the nodes.")
      .def_readonly("blocks", &TaskProblem::blocks, "Parts, taken apart where robots only hold each other.");
}

void add_task_solutions(py::module_& m) {
  py::class_<TaskIteration> iteration(m, "TaskIteration");
  add_value(iteration)
      .def_readonly("cost", &TaskIteration::cost)
      .def_readonly("stop", &TaskIteration::stop)
      .def_readonly("regularisation", &TaskIteration::regularisation)
      .def_readonly("step_length", &TaskIteration::step_length)
      .def_readonly("gaps", &TaskIteration::gaps)
      .def_readonly("feasible", &TaskIteration::feasible);
  py::class_<TaskViolation> violation(m, "TaskViolation", "How far a motion is from a constraint.");
  add_value(violation)
      .def_readonly("constraint", &TaskViolation::constraint)
      .def_readonly("by", &TaskViolation::by, "Largest distance of a row to its bounds.")
      .def_readonly("node", &TaskViolation::node);
  py::class_<TaskGains> gains(m, "TaskGains", "Feedback u = us[t] - K[t] (x (-) xs[t]) of robots solved together.");
  add_value(gains)
      .def_readonly("dx", &TaskGains::dx, "Their coordinates of dx.")
      .def_readonly("u", &TaskGains::u, "Their torques.")
      .def_readonly("K", &TaskGains::K, "Of each node (len(u), len(dx)); without rows at an impact. Copies.");
  py::class_<TaskTimes> times(m, "TaskTimes", "Per running node, medians over the iterations [us]; total [us].");
  add_value(times)
      .def_readonly("calc", &TaskTimes::calc)
      .def_readonly("calc_diff", &TaskTimes::calc_diff)
      .def_readonly("direction", &TaskTimes::direction)
      .def_readonly("total", &TaskTimes::total);
  py::class_<TaskSolution> solution(m, "TaskSolution", "What a solver did.");
  add_value(solution)
      .def_readonly("converged", &TaskSolution::converged)
      .def_readonly("cost", &TaskSolution::cost)
      .def_readonly("reason", &TaskSolution::reason, "Why it stopped, and the remarks.")
      .def_readonly("remarks", &TaskSolution::remarks, "What was done where a solver's own rule failed.")
      .def_readonly("multipliers", &TaskSolution::multipliers, "Of each node's constraints [g; h].")
      .def_readonly("iterations", &TaskSolution::iterations, "List of TaskIteration.")
      .def_readonly("polishing_iterations", &TaskSolution::polishing_iterations, "After these, to the KKT residual.")
      .def_readonly("xs", &TaskSolution::xs, "nodes + 1 states (nq + nv).")
      .def_readonly("us", &TaskSolution::us, "Torques (nu) of each node [N m, N]; none at an impact.")
      .def_readonly("gains", &TaskSolution::gains, "List of TaskGains; empty where the solver has none.")
      .def_readonly("solver", &TaskSolution::solver)
      .def_readonly("direction", &TaskSolution::direction, "How directions were found.")
      .def_readonly("blocks", &TaskSolution::blocks, "Sizes of the matrices factorized at a node, by part or cluster.")
      .def_readonly("times", &TaskSolution::times, "TaskTimes")
      .def_readonly("kkt_residual", &TaskSolution::kkt_residual)
      .def_readonly("constraint_violation", &TaskSolution::constraint_violation)
      .def_readonly("violations", &TaskSolution::violations, "List of TaskViolation.")
      .def_readonly("outer_iterations", &TaskSolution::outer_iterations);
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
      py::arg("path"), Unlocked(), "A task from its XML file. Raises InputError (a ValueError).");
  m.attr("load_task") = m.attr("read_task");
  m.def(
      "make_problem",
      [](const TaskFile& task, std::optional<TaskSolver> solver) {
        return std::make_shared<TaskProblem>(make_problem(task, solver.value_or(task.solver)));
      },
      py::arg("task"), py::arg("solver") = py::none(), Unlocked(),
      "The task's ShootingProblem and its initial guess. solver: None, the task's own; 'sparse' and 'auto' take parts\n"
      "where robots never meet, 'fddp' nodes of the whole scene (herds: hundreds of times the memory).\n"
      "Raises InputError where the nodes would not fit into memory.");
  m.def("optimize", &optimize_task, py::arg("task"), py::arg("problem") = py::none(), py::arg("solver") = py::none(),
        py::arg("threads") = 0, py::arg("each") = py::none(),
        "Finds the motion and torques of least cost; returns a TaskSolution. solver: None, the task's own. problem:\n"
        "of make_problem with the same solver, for a guess of one's own. each(TaskIteration) is called after each\n"
        "iteration; False ends the solve. Ctrl-C raises KeyboardInterrupt.");
  add_simulated_motion(m);
}

}  // namespace manycontact::python
