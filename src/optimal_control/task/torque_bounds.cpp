#include "torque_bounds.hpp"

#include <algorithm>
#include <limits>

#include "manycontact/task/parts.hpp"

namespace manycontact::task {

namespace {

constexpr double kNone = std::numeric_limits<double>::infinity();

// Intersects the bounds with those of one term. The term's numbers are repeated for each of its robots.
void add_term(const TaskFile& task, const TaskTerm& term, TorqueBounds& out) {
  const Scene& scene = task.scene.scene;
  std::vector<int> rows;
  if (term.robots.empty()) rows = internal::range(0, scene.nu);
  for (const int r : term.robots) {
    const std::vector<int> own = rows_of(term.residual, scene, {r});
    rows.insert(rows.end(), own.begin(), own.end());
  }
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const Eigen::Index i = static_cast<Eigen::Index>(k) % term.nr;
    const double reference = term.reference.size() > 0 ? term.reference[i] : 0;
    double &lower = out.lower[rows[k]], &upper = out.upper[rows[k]];
    if (term.lower.size() > 0) lower = std::max(lower, reference + term.lower[i]);
    if (term.upper.size() > 0) upper = std::min(upper, reference + term.upper[i]);
  }
}

void set_limits(const TorqueBounds& bounds, ActionModelAbstract& model) {
  if (model.get_nu() == 0) return;
  if (const auto* whole = dynamic_cast<const ActionModelParts*>(&model); whole && !whole->get_couplings())
    for (const ActionPart& part : whole->get_parts()) {
      TorqueBounds own;
      gather(bounds.lower, part.u, own.lower);
      gather(bounds.upper, part.u, own.upper);
      set_limits(own, *part.model);
    }
  model.set_u_lb(bounds.lower);
  model.set_u_ub(bounds.upper);
}

}  // namespace

bool bounds_torques_alone(const TaskFile& task, std::vector<TorqueBounds>& bounds) {
  const int nu = task.scene.scene.nu;
  bounds.clear();
  if (nu == 0 || !task.terminal.constraints.empty()) return false;
  for (const TaskPhase& phase : task.phases) {
    TorqueBounds own{Eigen::VectorXd::Constant(nu, -kNone), Eigen::VectorXd::Constant(nu, kNone)};
    for (const TaskTerm& term : phase.constraints) {
      if (term.residual != TaskResidual::kControl && term.residual != TaskResidual::kJointEffort) return false;
      add_term(task, term, own);
    }
    if ((own.lower.array() > own.upper.array()).any()) return false;  // no torques are admissible
    bounds.push_back(std::move(own));
  }
  return true;
}

TaskFile without_constraints(TaskFile task) {
  for (TaskPhase& phase : task.phases) phase.constraints.clear();
  task.terminal.constraints.clear();
  return task;
}

void limit_torques(const TaskFile& task, const std::vector<TorqueBounds>& bounds, TaskProblem& problem) {
  const std::vector<TaskNode> nodes = timeline(task);
  for (std::size_t t = 0; t < problem.us.size(); ++t) {
    if (nodes[t].impact) continue;
    TorqueBounds own = bounds[nodes[t].phase];
    ActionModelAbstract& model = *problem.problem->model(t);
    if (task.solver == TaskSolver::kBoxFddp) {
      own.lower = own.lower.cwiseMax(model.get_u_lb());
      own.upper = own.upper.cwiseMin(model.get_u_ub());
    }
    set_limits(own, model);
    problem.us[t] = problem.us[t].cwiseMax(own.lower).cwiseMin(own.upper);
  }
}

}  // namespace manycontact::task
