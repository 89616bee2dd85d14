#pragma once
// The results of `manycontact optimize`, and the functions that write them.

#include <iosfwd>
#include <optional>

#include "manycontact/task/forces.hpp"
#include "manycontact/task/plan.hpp"
#include "manycontact/task/simulate.hpp"

namespace manycontact::cli {

struct Recording;

struct OptimizedTask {
  const TaskFile& task;
  const TaskProblem& problem;  // evaluated at the solution
  const TaskSolution& solution;
  const std::vector<TaskNode> nodes;
  std::optional<SimulatedMotion> simulation;
  std::vector<PlanCost> costs = {};  // one entry per cost of the task file
  std::vector<PlanFinding> findings = {};
};

/// Writes task, solution, findings and report as JSON to `path`. "-" is standard output. Throws InputError on failure.
void write_json(const OptimizedTask& motion, const std::string& path);

/// Writes a CSV file with the columns of `simulate`, a row per node except impacts, which have the next node's time.
void write_trajectory(const OptimizedTask& motion, const std::string& path);

/// Writes t and one column per torque (u:robot/joint), one row per node. `simulate --torques` reads this file.
void write_torques(const OptimizedTask& motion, const std::string& path);
/// Writes t and the columns of `simulate --forces`, one row per node, with zeros for open contacts.
void write_forces(const OptimizedTask& motion, const std::string& path);

/// Draws convergence, torques, forces as .svg and .png in the folder, from charts.json. Throws as run_python does.
void draw_charts(const OptimizedTask& motion, const std::string& folder);

/// Records the states as frames of a view, with the torques and friction cones of the task.
void record_motion(const OptimizedTask& motion, Recording& recording);

/// Returns the smallest friction coefficient of the cones on a contact in the phase, or infinity if there are none.
double friction_of(const TaskPhase& phase, int contact);

void print_summary(std::ostream& out, const OptimizedTask& motion);
/// Print parts of the summary: the motion of robots and frames, the largest torques, contact forces, and costs.
void print_motion(std::ostream& out, const OptimizedTask& motion);
void print_torques(std::ostream& out, const OptimizedTask& motion);
void print_forces(std::ostream& out, const OptimizedTask& motion);
void print_costs(std::ostream& out, const OptimizedTask& motion);
void print_plan_findings(std::ostream& out, const OptimizedTask& motion);

}  // namespace manycontact::cli
