// Motions of task files.

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
  value<SimulatedMotion>(m, "SimulatedMotion")
      .read("stopped", &SimulatedMotion::stopped, "xs", &SimulatedMotion::xs, "energy_lost",
            &SimulatedMotion::energy_lost, "position_drift", &SimulatedMotion::position_drift, "velocity_drift",
            &SimulatedMotion::velocity_drift, "distance", &SimulatedMotion::distance);
  def_as(
      m, "simulate", "simulate_solution",
      [](const TaskFile& task, const TaskSolution& solution, Integrator integrator, int substeps) {
        return manycontact::simulate(task, solution, integrator, substeps);
      },
      Unlocked());
}

void add_task_files(py::module_& m) {
  enumeration<TaskSolver>(m, "TaskSolver");
  value<TaskFile, std::shared_ptr<TaskFile>>(m, "TaskFile")
      .read(
          "path", &TaskFile::path, "name", &TaskFile::name, "scene",
          [](const std::shared_ptr<TaskFile>& t) { return std::shared_ptr<SceneFile>(t, &t->scene); }, "step",
          &TaskFile::step)
      .write("solver", &TaskFile::solver, "iterations", &TaskFile::iterations, "tolerance", &TaskFile::tolerance)
      .read("nodes", &TaskFile::nodes);
  shared<TaskProblem>(m, "TaskProblem")
      .read("state", &TaskProblem::state, "actuation", &TaskProblem::actuation, "models", &TaskProblem::models,
            "problem", &TaskProblem::problem)
      .write("xs", &TaskProblem::xs, "us", &TaskProblem::us, "multipliers", &TaskProblem::multipliers)
      .read("parts", &TaskProblem::parts, "blocks", &TaskProblem::blocks);
}

void add_task_solutions(py::module_& m) {
  value<TaskIteration>(m, "TaskIteration")
      .read("cost", &TaskIteration::cost, "stop", &TaskIteration::stop, "regularisation",
            &TaskIteration::regularisation, "step_length", &TaskIteration::step_length, "gaps", &TaskIteration::gaps,
            "feasible", &TaskIteration::feasible);
  value<TaskViolation>(m, "TaskViolation")
      .read("constraint", &TaskViolation::constraint, "by", &TaskViolation::by, "node", &TaskViolation::node);
  auto gains = value<TaskGains>(m, "TaskGains");
  gains.read("dx", &TaskGains::dx, "u", &TaskGains::u, "K", &TaskGains::K);
  auto times = value<TaskTimes>(m, "TaskTimes");
  times.read("calc", &TaskTimes::calc, "calc_diff", &TaskTimes::calc_diff, "direction", &TaskTimes::direction, "total",
             &TaskTimes::total);
  value<TaskSolution>(m, "TaskSolution")
      .read("converged", &TaskSolution::converged, "cost", &TaskSolution::cost, "reason", &TaskSolution::reason,
            "remarks", &TaskSolution::remarks, "multipliers", &TaskSolution::multipliers, "iterations",
            &TaskSolution::iterations, "polishing_iterations", &TaskSolution::polishing_iterations, "xs",
            &TaskSolution::xs, "us", &TaskSolution::us, "gains", &TaskSolution::gains, "solver", &TaskSolution::solver,
            "direction", &TaskSolution::direction, "blocks", &TaskSolution::blocks, "times", &TaskSolution::times,
            "kkt_residual", &TaskSolution::kkt_residual, "constraint_violation", &TaskSolution::constraint_violation,
            "violations", &TaskSolution::violations, "outer_iterations", &TaskSolution::outer_iterations);
}

}  // namespace

void add_task(py::module_& m) {
  add_task_files(m);
  add_task_solutions(m);
  def(
      m, "read_task",
      [](const std::string& path) {
        const auto task = std::make_shared<TaskFile>(read_task(path));
        fit_state(*task);
        return task;
      },
      Unlocked());
  m.attr("load_task") = m.attr("read_task");
  def(
      m, "make_problem",
      [](const TaskFile& task, std::optional<TaskSolver> solver) {
        return std::make_shared<TaskProblem>(make_problem(task, solver.value_or(task.solver)));
      },
      Unlocked());
  def(m, "optimize", &optimize_task);
  add_simulated_motion(m);
}

}  // namespace manycontact::python
