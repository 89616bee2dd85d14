#pragma once
// The shooting problem of a task file: one differential model per phase, shared by its nodes, integrated over the
// task's step; the terminal node is Euler's with step 0. Before the nodes of a phase with an impact stands one of
// ActionModelImpulseFwdDynamics: no controls, no costs, and v+ the nearest velocity that all the phase's contacts
// allow.
//
// A term about copied robots holds for every copy: places, and twists and momenta in world axes, are given for the
// robot as its element places it and are moved as `arrange` moves the copies; a reference left out is the copy's own
// x0.

#include "manycontact/action/contact_fwddyn.hpp"
#include "manycontact/control/shooting.hpp"
#include "manycontact/io/task_file.hpp"

namespace manycontact {

struct TaskProblem {  // A task as a shooting problem.
  std::shared_ptr<StateMultibody> state;
  std::shared_ptr<ActuationModelAbstract> actuation;
  std::vector<std::shared_ptr<DifferentialActionModelContactFwdDynamics>> models;  // per phase, then the terminal node
  std::shared_ptr<ShootingProblem> problem;
  std::vector<Eigen::VectorXd> xs, us;   // initial guess
  std::vector<std::vector<int>> parts;   // robots that meet, of each part of the nodes
  std::vector<std::vector<int>> blocks;  // parts, taken apart at their couplings; one: nodes of the whole scene
  std::vector<Eigen::VectorXd> multipliers = {};  // guess of the constraints', as TaskSolution has them; none: zeros
};

/// Whether any node has constraints.
bool has_constraints(const TaskFile& task);

/// Nodes for this solver. kSparse: ActionModelParts of separate_robots, without matrices of the whole scene; parts that
/// divide_robots takes apart (task/joined.hpp) are coupled nodes of these blocks, unless their couplings depend on each
/// other at x0. kAuto: likewise, but a part is taken apart only where that is predicted to be cheaper. kBoxFddp: parts
/// are not taken apart. With a single block, and for kFddp, nodes of the whole scene.
/// Throws InputError where a term does not fit the models, with the task's file and line, and where the nodes would not
/// fit into memory.
TaskProblem make_problem(const TaskFile& task, TaskSolver solver);
/// For the task's own solver.
TaskProblem make_problem(const TaskFile& task);

struct TaskNode {       // A node of a task's horizon.
  int phase = 0;        // of the task's; as many as there are: the terminal one
  bool impact = false;  // the one before the phase's, which takes no time
  double time = 0;      // at its start, s
};
/// The running nodes, then the terminal one.
std::vector<TaskNode> timeline(const TaskFile& task);
/// Its phase, or the terminal node's terms.
const TaskPhase& phase_at(const TaskFile& task, const TaskNode& node);

}  // namespace manycontact
