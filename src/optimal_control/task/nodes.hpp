#pragma once
// Functions that make the nodes of a task file's phases, and the costs and constraints of its terms.

#include "manycontact/action/constraint.hpp"
#include "manycontact/action/cost.hpp"
#include "manycontact/detail/control/parts.hpp"
#include "manycontact/task/problem.hpp"

namespace manycontact::task {

using DiffModel = DifferentialActionModelContactFwdDynamics;

/// Returns ActuationModelFull if no robot has a floating base or passive joints, otherwise an actuation of the active
/// joints.
std::shared_ptr<ActuationModelAbstract> actuation_of(const std::shared_ptr<StateMultibody>& state);

/// Makes the differential model of a phase. Throws InputError if a term does not fit.
std::shared_ptr<DiffModel> model_of(const TaskFile& task, const TaskPhase& phase,
                                    const std::shared_ptr<StateMultibody>& state,
                                    const std::shared_ptr<ActuationModelAbstract>& actuation, MatrixStorage storage);

/// Makes a node with the task's integrator.
std::shared_ptr<ActionModelAbstract> integrated(const TaskFile& task, const std::shared_ptr<DiffModel>& model);
std::shared_ptr<ActionModelAbstract> terminal_of(const std::shared_ptr<DiffModel>& model);

struct Nodes {
  std::vector<std::shared_ptr<ActionModelAbstract>> phases, impacts;  // one entry per phase; impacts: null for none
  std::shared_ptr<ActionModelAbstract> terminal;
};

Scene scene_with(const TaskFile& task, const std::vector<bool>& active);  // returns the scene with a phase's contacts
Scene scene_in(const TaskFile& task, const TaskPhase& phase);
/// Returns the number of linearly dependent contact rows at x0, computed without the scene's damping.
int dependent_rows(Scene scene, const Eigen::VectorXd& x0);

/// Returns whether a contact that is active in the phase (or in the terminal node) closed after the first phase, and
/// constrains its frames to the placements at that time. Its placement error is then not corrected.
bool holds_where_it_closed(const TaskFile& task, const TaskPhase& phase, std::size_t contact);

/// Returns for each phase the guess of the torques, which are quasi-static at the configuration of x0, or zero.
std::vector<Eigen::VectorXd> guess_of(const TaskFile& task);

/// Makes the nodes as coupled ActionModelParts, with one block for each of the given groups of the task's robots.
Nodes joined_nodes(const TaskFile& task, const std::vector<std::vector<int>>& groups);

// ---- terms

struct Parts {  // the models of a phase or impact that its terms (costs and constraints) refer to
  const TaskFile& task;
  std::shared_ptr<StateMultibody> state;
  std::shared_ptr<ActuationModelAbstract> actuation;  // null for an impact, whose terms depend only on x
  std::shared_ptr<ContactModelMultiple> contacts;
  std::size_t nu() const { return actuation ? actuation->get_nu() : 0; }
};

Eigen::VectorXd x0_of(const SceneFile& file);  // returns the state (q, v) of the scene file

/// Add the costs or the constraints of a term. Throw std::invalid_argument if the term does not fit the scene.
void add_cost(const TaskTerm& term, const Parts& parts, CostModelSum& costs);
void add_constraint(const TaskTerm& term, const Parts& parts, ConstraintModelManager& constraints);

}  // namespace manycontact::task
