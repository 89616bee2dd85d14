#pragma once
// The shooting problem of a task file. The nodes of a phase share one differential model, integrated with the task's
// step. The terminal node is an Euler step of size 0. A phase with an impact begins with a node of
// ActionModelImpulseFwdDynamics without controls and costs: v+ is the nearest velocity that the phase's contacts allow.
//
// A term for copied robots applies to every copy. References in world axes (placements, twists, momenta) are given for
// the original robot, and are moved as `arrange` moves the copies. A missing reference is the x0 of each copy.

#include "manycontact/action/contact_fwddyn.hpp"
#include "manycontact/control/shooting.hpp"
#include "manycontact/io/task_file.hpp"

namespace manycontact {

struct TaskProblem {  // A task as a shooting problem.
  std::shared_ptr<StateMultibody> state;
  std::shared_ptr<ActuationModelAbstract> actuation;
  /// One model per phase, then the model of the terminal node.
  std::vector<std::shared_ptr<DifferentialActionModelContactFwdDynamics>> models;
  std::shared_ptr<ShootingProblem> problem;
  std::vector<Eigen::VectorXd> xs, us;   // initial guess
  std::vector<std::vector<int>> parts;   // robots of each decoupled subproblem
  std::vector<std::vector<int>> blocks;  // robots of each block of the nodes; one block: nodes of the whole scene
  std::vector<Eigen::VectorXd> multipliers = {};  // initial guess of the constraints' multipliers; empty: zeros
};

/// Returns whether any node has constraints.
bool has_constraints(const TaskFile& task);

/// Makes the problem with the nodes that the solver needs. For kFddp, or a single block, they are nodes of the whole
/// scene. Otherwise they are ActionModelParts, without matrices of the whole scene. A coupled subproblem is divided
/// into blocks if its couplings are linearly independent at x0. kAuto divides a subproblem only if fewer operations are
/// predicted for blocks, and kBoxFddp never divides a subproblem.
///
/// Throws InputError, with file and line, if a term does not fit the models, or nodes do not fit into memory.
TaskProblem make_problem(const TaskFile& task, TaskSolver solver);
/// Makes the problem for the solver that the task file selects (TaskFile::solver).
TaskProblem make_problem(const TaskFile& task);

struct TaskNode {       // A node of a task's horizon.
  int phase = 0;        // number of the node's phase; in the terminal node the number of phases
  bool impact = false;  // whether the node is the impact before the phase, which takes no time
  double time = 0;      // start of the node, s
};
/// Lists the running nodes, then the terminal node.
std::vector<TaskNode> timeline(const TaskFile& task);
/// Returns the phase of a node, or the terms of the terminal node.
const TaskPhase& phase_at(const TaskFile& task, const TaskNode& node);

}  // namespace manycontact
