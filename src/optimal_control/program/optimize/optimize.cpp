#include "optimize.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iomanip>
#include <iostream>

#include "manycontact/analysis/load_scene.hpp"
#include "program/command/command.hpp"
#include "program/command/interrupt.hpp"
#include "program/files/python.hpp"
#include "program/text/table.hpp"
#include "program/view/view.hpp"

namespace manycontact::cli {

namespace {

const std::vector<std::string> kFiles = {"--out", "--json", "--view", "--torques", "--forces"};

std::optional<TaskSolver> task_solver(const Arguments& arguments) {
  const auto name = arguments.value("--solver");
  if (!name) return std::nullopt;
  for (const TaskSolver solver : {TaskSolver::kFddp, TaskSolver::kBoxFddp, TaskSolver::kSparse, TaskSolver::kAuto})
    if (*name == to_string(solver)) return solver;
  throw UsageError("unknown solver '" + *name + "', expected fddp, box-fddp, sparse or auto");
}

// Prints one line per iteration on standard error.
void show(std::size_t k, const TaskIteration& i) {
  if (k % 20 == 0) std::cerr << "iteration          cost       gaps       stop    step  regularisation\n";
  std::ostringstream line;
  line << std::setw(9) << k << std::setw(14) << number(i.cost, 8) << std::setw(11) << scientific(i.gaps)
       << std::setw(11) << scientific(i.stop) << std::setw(8) << number(i.step_length) << std::setw(16)
       << scientific(i.regularisation) << "\n";
  std::cerr << line.str();
}

// Throws if a chart would overwrite an input file or the output of another option.
void check_charts(const Arguments& arguments, const std::string& path, const TaskFile& task,
                  const std::string& folder) {
  std::vector<std::string> names{"charts.json"}, others = task.scene.files;
  for (const char* name : {"convergence", "torques", "forces"})
    for (const char* kind : {".svg", ".png"}) names.push_back(std::string(name) + kind);
  others.push_back(path);
  for (const std::string& option : kFiles)
    if (const auto file = arguments.value(option)) others.push_back(*file);
  check_folder("--charts", folder, names, others);
}

// Creates the folder for charts, and checks that the plotting program exists. This is called before the solve.
void prepare_charts(const std::string& folder) {
  if (!find_python().draws) throw InputError(folder, 1, kNoCharts);
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw InputError(folder, 1, "cannot be created: " + error.message() + ", expected a folder for --charts");
}

std::optional<SimulatedMotion> simulated(const Arguments& arguments, const TaskFile& task,
                                         const TaskSolution& solution) {
  if (!arguments.has("--simulate")) return std::nullopt;
  const double substeps = std::clamp(std::ceil(task.step / arguments.positive("--simulate") - 1e-9), 1.0, 1e9);
  return manycontact::simulate(task, solution, Integrator::kRk4, static_cast<int>(substeps));
}

}  // namespace

int run_optimize(const Arguments& arguments) {
  const std::string path = scene_operand(arguments, "TASK");
  const std::optional<TaskSolver> solver = task_solver(arguments);
  const int threads = arguments.integer("--threads", 1, kMostThreads, 0);
  if (arguments.has("--simulate")) (void)arguments.positive("--simulate");  // throws for a wrong value before the solve
  const std::string out = arguments.required("--out");
  const auto json = arguments.value("--json"), charts = arguments.value("--charts");
  check_files(arguments, {path}, kFiles);

  TaskFile task = read_task(path);
  fit_state(task);
  check_files(arguments, task.scene.files, kFiles);
  if (charts) check_charts(arguments, path, task, *charts);
  const TaskSolver chosen = solver.value_or(task.solver);
  TaskProblem problem = make_problem(task, chosen);
  check_writable(out, "--out");
  for (const char* option : {"--json", "--torques", "--forces"})
    if (const auto file = arguments.value(option)) check_writable(*file, option);
  if (charts) prepare_charts(*charts);
  std::optional<Recording> view = recording_of(arguments, task.scene.scene);

  const InterruptFlag stop;
  std::size_t k = 0;
  const TaskSolution solution = optimize(task, problem, {chosen, threads, [&](const TaskIteration& iteration) {
                                                           show(k++, iteration);
                                                           return !stop.is_set();
                                                         }});
  problem.problem->calc(solution.xs, solution.us);
  OptimizedTask motion{
      task, problem, solution, timeline(task), simulated(arguments, task, solution), cost_by_term(task, problem)};
  motion.findings = plan_findings(task, solution, motion.costs);
  for (PlanFinding& finding : guess_findings(task)) motion.findings.push_back(std::move(finding));
  write_trajectory(motion, out);
  if (const auto file = arguments.value("--torques")) write_torques(motion, *file);
  if (const auto file = arguments.value("--forces")) write_forces(motion, *file);
  if (json) write_json(motion, *json);
  if (charts) draw_charts(motion, *charts);
  const bool summary = !is_standard_output(arguments, {"--out", "--json", "--torques", "--forces"});
  if (summary) print_summary(std::cout, motion);
  if (view) record_motion(motion, *view);
  finish_view(arguments, task.scene, view, summary ? &std::cout : nullptr);
  return solution.converged ? kExitOk : kExitUnsound;
}

}  // namespace manycontact::cli
