#include "action.hpp"
#include "manycontact/analysis/load_scene.hpp"
#include "manycontact/task/simulate.hpp"

namespace manycontact::python {

namespace {

// Calls optimize. solver: None means the task's. each(TaskIteration) ends the solve by returning False.
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
  value<SimulatedMotion>(m)
      .read<&SimulatedMotion::stopped, &SimulatedMotion::xs, &SimulatedMotion::energy_lost,
            &SimulatedMotion::violation_position, &SimulatedMotion::violation_velocity, &SimulatedMotion::distance>();
  def_as(
      m, "simulate", "simulate_solution",
      [](const TaskFile& task, const TaskSolution& solution, Integrator integrator, int substeps) {
        return manycontact::simulate(task, solution, integrator, substeps);
      },
      Unlocked());
}

void add_task_files(py::module_& m) {
  enumeration<TaskSolver>(m);
  value<TaskFile, std::shared_ptr<TaskFile>>(m)
      .read<&TaskFile::path, &TaskFile::name, &TaskFile::step, &TaskFile::nodes>()
      .read("scene", [](const std::shared_ptr<TaskFile>& t) { return std::shared_ptr<SceneFile>(t, &t->scene); })
      .write<&TaskFile::solver, &TaskFile::iterations, &TaskFile::tolerance>();
  shared<TaskProblem>(m)
      .read<&TaskProblem::state, &TaskProblem::actuation, &TaskProblem::models, &TaskProblem::problem,
            &TaskProblem::parts, &TaskProblem::blocks>()
      .write<&TaskProblem::xs, &TaskProblem::us, &TaskProblem::multipliers>();
}

void add_task_solutions(py::module_& m) {
  value<TaskIteration>(m)
      .read<&TaskIteration::cost, &TaskIteration::stop, &TaskIteration::regularisation, &TaskIteration::step_length,
            &TaskIteration::gaps, &TaskIteration::feasible>();
  value<TaskViolation>(m).read<&TaskViolation::constraint, &TaskViolation::by, &TaskViolation::node>();
  value<TaskGains>(m).read<&TaskGains::dx, &TaskGains::u, &TaskGains::K>();
  value<TaskTimes>(m).read<&TaskTimes::calc, &TaskTimes::calc_diff, &TaskTimes::direction, &TaskTimes::total>();
  value<TaskSolution>(m)
      .read<&TaskSolution::converged, &TaskSolution::cost, &TaskSolution::reason, &TaskSolution::remarks,
            &TaskSolution::multipliers, &TaskSolution::iterations, &TaskSolution::polishing_iterations,
            &TaskSolution::xs, &TaskSolution::us, &TaskSolution::gains, &TaskSolution::solver, &TaskSolution::direction,
            &TaskSolution::blocks, &TaskSolution::times, &TaskSolution::kkt_residual,
            &TaskSolution::constraint_violation, &TaskSolution::violations, &TaskSolution::outer_iterations>();
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
