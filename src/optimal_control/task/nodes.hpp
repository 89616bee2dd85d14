#pragma once
// The parts of nodes, phase by phase.

#include "manycontact/detail/control/parts.hpp"
#include "manycontact/task/problem.hpp"

namespace manycontact::task {

using DiffModel = DifferentialActionModelContactFwdDynamics;

/// Actuates all coordinates but floating bases; every coordinate if no robot has a floating base.
std::shared_ptr<ActuationModelAbstract> actuation_of(const std::shared_ptr<StateMultibody>& state);

/// Throws InputError where a term does not fit.
std::shared_ptr<DiffModel> model_of(const TaskFile& task, const TaskPhase& phase,
                                    const std::shared_ptr<StateMultibody>& state,
                                    const std::shared_ptr<ActuationModelAbstract>& actuation, MatrixStorage storage);

/// The node of the task's integrator.
std::shared_ptr<ActionModelAbstract> integrated(const TaskFile& task, const std::shared_ptr<DiffModel>& model);
std::shared_ptr<ActionModelAbstract> terminal_of(const std::shared_ptr<DiffModel>& model);

/// The impact between a phase and the next one's nodes, with the first one's constraints on the state.
std::shared_ptr<ActionModelAbstract> impact_of(const TaskFile& task, const TaskPhase& before, const TaskPhase& phase,
                                               const std::shared_ptr<StateMultibody>& state);

struct Nodes {
  std::vector<std::shared_ptr<ActionModelAbstract>> phases, impacts;  // one entry per phase; impacts: null without one
  std::shared_ptr<ActionModelAbstract> terminal;
};

/// The scene with a phase's contacts.
Scene scene_with(const TaskFile& task, const std::vector<bool>& active);
/// The same with the external wrenches of the phase.
Scene scene_in(const TaskFile& task, const TaskPhase& phase);
/// Contact rows that depend on others, at x0, without damping: with it every row counts.
int dependent_rows(Scene scene, const Eigen::VectorXd& x0);

/// Whether a contact that is active in the phase (or the terminal node) closed during the motion and fixes its frames
/// where they were then: its placement error is not corrected.
bool holds_where_it_closed(const TaskFile& task, const TaskPhase& phase, std::size_t contact);

/// Torques of each phase: quasi-static at x0 without its velocity, or zero.
std::vector<Eigen::VectorXd> guess_of(const TaskFile& task);

/// ActionModelParts, coupled, of these groups of the task's robots.
Nodes joined_nodes(const TaskFile& task, const std::vector<std::vector<int>>& groups);

}  // namespace manycontact::task
