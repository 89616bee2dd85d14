#include "manycontact/task/violations.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "manycontact/analysis/findings.hpp"
#include "manycontact/control/impulse_fwddyn.hpp"
#include "manycontact/control/integrated_action.hpp"
#include "manycontact/detail/control/parts.hpp"
#include "manycontact/dynamics/views.hpp"

namespace manycontact {

namespace {

using Worst = std::map<std::string, TaskViolation>;

// Returns the largest distance of rows [first, first + count) of g from their bounds, or infinity if one is NaN.
double distance(const Eigen::VectorXd& g, const Eigen::VectorXd& lower, const Eigen::VectorXd& upper,
                Eigen::Index first, Eigen::Index count) {
  double out = 0;
  for (Eigen::Index i = first; i < first + count; ++i)
    out = std::max(std::isnan(g[i]) ? INFINITY : out, std::max(lower[i] - g[i], g[i] - upper[i]));
  return out;
}

// Updates the worst violation of each constraint with the rows of one node. g and h are stacked in the order of names.
void add_rows(std::size_t t, const ConstraintModelManager& constraints, bool terminal, const ActionDataAbstract& data,
              Worst& worst) {
  const Eigen::VectorXd& lower = terminal ? constraints.get_lb_T() : constraints.get_lb();
  const Eigen::VectorXd& upper = terminal ? constraints.get_ub_T() : constraints.get_ub();
  const Eigen::VectorXd zeros = Eigen::VectorXd::Zero(data.h.size());
  Eigen::Index g = 0, h = 0;
  for (const auto& [name, item] : constraints.get_constraints()) {
    if (!item->active || (terminal && !item->constraint->get_T_constraint())) continue;
    const Eigen::Index ng = static_cast<Eigen::Index>(item->constraint->get_ng());
    const Eigen::Index nh = static_cast<Eigen::Index>(item->constraint->get_nh());
    const double by = std::max(distance(data.g, lower, upper, g, ng), distance(data.h, zeros, zeros, h, nh));
    g += ng;
    h += nh;
    TaskViolation& own = worst.try_emplace(name, TaskViolation{name, -1, t}).first->second;
    if (by > own.by) own.by = by, own.node = t;
  }
}

// Collects the violations of a node and of its subproblems.
void add_node(std::size_t t, const ActionModelAbstract& model, bool terminal, const ActionDataAbstract& data,
              Worst& worst) {
  if (const auto* whole = dynamic_cast<const ActionModelParts*>(&model)) {
    const auto& parts = dynamic_cast<const ActionDataParts&>(data).parts;
    for (std::size_t i = 0; i < parts.size(); ++i)
      add_node(t, *whole->get_parts()[i].model, terminal, *parts[i], worst);
  } else if (const auto* node = dynamic_cast<const IntegratedActionModelAbstract*>(&model)) {
    const auto& dynamics = dynamic_cast<const DifferentialActionModelContactFwdDynamics&>(*node->get_differential());
    if (dynamics.get_constraints()) add_rows(t, *dynamics.get_constraints(), terminal, data, worst);
  } else if (const auto* impact = dynamic_cast<const ActionModelImpulseFwdDynamics*>(&model)) {
    if (impact->get_constraints()) add_rows(t, *impact->get_constraints(), terminal, data, worst);
  }
}

// ---- states whose dynamics fail

std::string robots_of(const Scene& scene, const Island& island) {
  std::string out;
  for (const int r : island.robots) out += (out.empty() ? "" : ", ") + scene.robots[r].name;
  return out;
}

void add_dynamics(std::size_t t, const DifferentialActionDataAbstract& data, std::vector<TaskFailure>& out) {
  const auto& own = dynamic_cast<const DifferentialActionDataContactFwdDynamics&>(data);
  const Scene& scene = own.multibody->scene;
  const SceneData& solution = own.multibody->solution;
  const std::vector<IslandReport>& islands = solution.report.islands;
  bool fails = false;
  for (std::size_t i = 0; i < islands.size(); ++i) {
    if (islands[i].status != Status::kFailed) continue;
    fails = true;
    if (islands[i].reason != Reason::kSingularInertia)
      out.push_back({t, "failed", robots_of(scene, solved_island(solution, i)), to_string(islands[i].reason)});
  }
  if (!fails) return;
  for (const MasslessJoint& joint : massless_joints(scene, solution, own.x.head(scene.nq)))
    out.push_back({t, "no_inertia", joint.joint, joint.why});
}

void add_node(std::size_t t, const ActionDataAbstract& data, std::vector<TaskFailure>& out) {
  if (const auto* whole = dynamic_cast<const ActionDataParts*>(&data)) {
    for (const auto& part : whole->parts) add_node(t, *part, out);
  } else if (const auto* own = dynamic_cast<const IntegratedActionDataAbstract*>(&data)) {
    for (std::size_t i = 0; i < own->stages() && (i == 0 || out.empty()); ++i)
      add_dynamics(t, *own->stage(i).differential, out);
  } else if (const auto* impact = dynamic_cast<const ActionDataImpulseFwdDynamics*>(&data)) {
    add_dynamics(t, *impact->dynamics, out);
  }
}

}  // namespace

std::vector<TaskViolation> violations(const TaskProblem& problem) {
  const ShootingProblem& shooting = *problem.problem;
  Worst worst;
  for (std::size_t t = 0; t <= shooting.get_T(); ++t)
    add_node(t, *shooting.model(t), shooting.by_state_alone(t), *shooting.data(t), worst);
  std::vector<TaskViolation> out;
  for (const auto& [name, own] : worst) out.push_back(own);
  return out;
}

std::vector<TaskFailure> failed_dynamics(const TaskProblem& problem) {
  std::vector<TaskFailure> out;
  for (std::size_t t = 0; t <= problem.problem->get_T() && out.empty(); ++t)
    add_node(t, *problem.problem->data(t), out);
  return out;
}

}  // namespace manycontact
