#pragma once
// The shooting problem of a task file. Each phase has one differential model, which its nodes share, integrated with
// the task's step. The terminal node is an Euler step of size 0. A phase with an impact begins with a node of
// ActionModelImpulseFwdDynamics without controls and costs: v+ is the nearest velocity that the phase's contacts allow.
//
// A term for copied robots applies to every copy. Placements, and twists and momenta in world axes, refer to the robot
// as its element places it; they are moved as `arrange` moves the copies. A missing reference is the x0 of the copy.

#include "manycontact/action/contact_fwddyn.hpp"
#include "manycontact/control/shooting.hpp"
#include "manycontact/io/task_file.hpp"

namespace manycontact {

struct TaskProblem {  // A task as a shooting problem.
  std::shared_ptr<StateMultibody> state;
  std::shared_ptr<ActuationModelAbstract> actuation;
  /// One model per phase, then that of the terminal node.
  std::vector<std::shared_ptr<DifferentialActionModelContactFwdDynamics>> models;
  std::shared_ptr<ShootingProblem> problem;
  std::vector<Eigen::VectorXd> xs, us;   // initial guess
  std::vector<std::vector<int>> parts;   // robots of each decoupled subproblem of the nodes
  std::vector<std::vector<int>> blocks;  // subproblems divided at couplings; a single one: nodes of the whole scene
  std::vector<Eigen::VectorXd> multipliers = {};  // initial guess of the constraints' multipliers; none: zeros
};

/// Whether any node has constraints.
bool has_constraints(const TaskFile& task);

/// Makes the problem with the nodes that this solver needs. For kFddp, or a single block, these are nodes of the whole
/// scene. For kSparse they are ActionModelParts, without matrices of the whole scene. A coupled subproblem is divided
/// into blocks, unless its couplings are linearly dependent at x0. With kAuto it is divided only if this is predicted
/// to be cheaper, and with kBoxFddp it is not divided.
///
/// Throws InputError, with file and line, if a term does not fit the models, or nodes do not fit into memory.
TaskProblem make_problem(const TaskFile& task, TaskSolver solver);
/// Makes the problem for the task's own solver.
TaskProblem make_problem(const TaskFile& task);

struct TaskNode {       // A node of a task's horizon.
  int phase = 0;        // number of its phase; the terminal node has the number of phases
  bool impact = false;  // whether it is the impact before the phase, which takes no time
  double time = 0;      // start of the node, s
};
/// The running nodes, then the terminal node.
std::vector<TaskNode> timeline(const TaskFile& task);
/// The phase of a node, or the terms of the terminal node.
const TaskPhase& phase_at(const TaskFile& task, const TaskNode& node);

}  // namespace manycontact
