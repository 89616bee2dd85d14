#pragma once
// The shooting problem of a task file: one differential model per phase, shared by its nodes, integrated over the
// task's step; the terminal node is Euler's with step 0.
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
  std::vector<Eigen::VectorXd> xs, us;  // initial guess
  std::vector<std::vector<int>> parts;  // robots of each part of the nodes; one: nodes of the whole scene
};

/// Nodes of the whole scene. Throws InputError where a term does not fit the models, with the task's file and line.
TaskProblem make_problem(const TaskFile& task);

/// Whether any node has constraints.
bool has_constraints(const TaskFile& task);

/// Nodes for this solver. kSparse: ActionModelParts of separate_robots, without matrices of the whole scene; so kAuto
/// where there is more than one part. With constraints always nodes of the whole scene.
TaskProblem make_problem(const TaskFile& task, TaskSolver solver);

/// Per running node, the index of its phase.
std::vector<int> phase_of_node(const TaskFile& task);

}  // namespace manycontact
