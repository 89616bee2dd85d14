#pragma once
// The parts of nodes, phase by phase, and the residuals, activations and bounds of their terms.

#include "manycontact/action/constraint.hpp"
#include "manycontact/action/cost.hpp"
#include "manycontact/detail/control/parts.hpp"
#include "manycontact/task/problem.hpp"

namespace manycontact::task {

using DiffModel = DifferentialActionModelContactFwdDynamics;

/// Actuates all coordinates except floating bases and passive joints; all coordinates if no robot has any of these.
std::shared_ptr<ActuationModelAbstract> actuation_of(const std::shared_ptr<StateMultibody>& state);

/// Makes the differential model of a phase. Throws InputError if a term does not fit.
std::shared_ptr<DiffModel> model_of(const TaskFile& task, const TaskPhase& phase,
                                    const std::shared_ptr<StateMultibody>& state,
                                    const std::shared_ptr<ActuationModelAbstract>& actuation, MatrixStorage storage);

/// Makes a node with the task's integrator.
std::shared_ptr<ActionModelAbstract> integrated(const TaskFile& task, const std::shared_ptr<DiffModel>& model);
std::shared_ptr<ActionModelAbstract> terminal_of(const std::shared_ptr<DiffModel>& model);

struct Nodes {
  std::vector<std::shared_ptr<ActionModelAbstract>> phases, impacts;  // one entry per phase; impacts: null without one
  std::shared_ptr<ActionModelAbstract> terminal;
};

/// Returns the scene with a phase's contacts.
Scene scene_with(const TaskFile& task, const std::vector<bool>& active);
/// Returns the scene with a phase's contacts and external wrenches.
Scene scene_in(const TaskFile& task, const TaskPhase& phase);
/// Returns the number of dependent contact rows at x0, without damping (with which no row is dependent).
int dependent_rows(Scene scene, const Eigen::VectorXd& x0);

/// Whether a contact that is active in the phase (or the terminal node) closed during the motion and fixes its frames
/// where they were then: its placement error is not corrected.
bool holds_where_it_closed(const TaskFile& task, const TaskPhase& phase, std::size_t contact);

/// Returns the torques of each phase: quasi-static at x0 without its velocity, or zero.
std::vector<Eigen::VectorXd> guess_of(const TaskFile& task);

/// Makes nodes of coupled ActionModelParts, whose blocks are these groups of the task's robots.
Nodes joined_nodes(const TaskFile& task, const std::vector<std::vector<int>>& groups);

// ---- terms

/// The context in which terms are made.
struct Parts {
  const TaskFile& task;
  std::shared_ptr<StateMultibody> state;
  std::shared_ptr<ActuationModelAbstract> actuation;  // null: an impact, which has terms of the state alone
  std::shared_ptr<ContactModelMultiple> contacts;
  std::size_t nu() const { return actuation ? actuation->get_nu() : 0; }
};

/// Returns (q, v) of the scene's file.
Eigen::VectorXd x0_of(const SceneFile& file);

/// Add a term to the sums. Both throw std::invalid_argument if the term does not fit.
void add_cost(const TaskTerm& term, const Parts& parts, CostModelSum& costs);
void add_constraint(const TaskTerm& term, const Parts& parts, ConstraintModelManager& constraints);

}  // namespace manycontact::task
