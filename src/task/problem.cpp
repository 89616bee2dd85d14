#include "manycontact/task/problem.hpp"

#include <algorithm>

#include "manycontact/control/euler.hpp"
#include "manycontact/control/rk.hpp"
#include "manycontact/task/parts.hpp"
#include "terms.hpp"

namespace manycontact {

namespace {

using DiffModel = DifferentialActionModelContactFwdDynamics;

// Misuse of the action floor is bad input here.
template <class F>
void blame(const TaskFile& task, int line, const F& f) {
  try {
    f();
  } catch (const std::invalid_argument& error) {
    throw InputError(task.path, line, error.what());
  }
}

std::shared_ptr<ActuationModelAbstract> actuation_of(const std::shared_ptr<StateMultibody>& state) {
  for (const Robot& robot : state->get_model()->scene().robots)
    if (robot.model->nu() < robot.model->nv) return std::make_shared<ActuationModelFloatingBase>(state);
  return std::make_shared<ActuationModelFull>(state);
}

std::shared_ptr<ContactModelMultiple> contacts_of(const TaskFile& task, const TaskPhase& phase,
                                                  const TaskProblem& problem) {
  const auto& contacts = task.scene.scene.contacts;
  const std::size_t nu = problem.actuation->get_nu();
  auto out = std::make_shared<ContactModelMultiple>(problem.state, nu);
  for (std::size_t c = 0; c < contacts.size(); ++c)
    if (phase.active[c])
      out->addContact(contacts[c].name, std::make_shared<ContactModelOfScene>(problem.state, contacts[c], nu));
  return out;
}

std::shared_ptr<DiffModel> model_of(const TaskFile& task, const TaskPhase& phase, const TaskProblem& problem,
                                    MatrixStorage storage) {
  const task::Parts parts{task, problem.state, problem.actuation, contacts_of(task, phase, problem)};
  auto costs = std::make_shared<CostModelSum>(problem.state, parts.nu());
  for (const TaskTerm& term : phase.costs) blame(task, term.line, [&] { task::add_cost(term, parts, *costs); });
  std::shared_ptr<ConstraintModelManager> constraints;
  if (!phase.constraints.empty()) {
    constraints = std::make_shared<ConstraintModelManager>(problem.state, parts.nu());
    for (const TaskTerm& term : phase.constraints)
      blame(task, term.line, [&] { task::add_constraint(term, parts, *constraints); });
  }
  auto model = std::make_shared<DiffModel>(problem.state, problem.actuation, parts.contacts, costs, constraints,
                                           task.scene.scene.damping);
  model->set_storage(storage);
  blame(task, phase.line, [&] { (void)model->createData(); });
  return model;
}

// State, actuation and differential models.
TaskProblem models_of(const TaskFile& task, MatrixStorage storage) {
  TaskProblem out;
  out.state = std::make_shared<StateMultibody>(task.scene.scene);
  out.actuation = actuation_of(out.state);
  for (const TaskPhase& phase : task.phases) out.models.push_back(model_of(task, phase, out, storage));
  out.models.push_back(model_of(task, task.terminal, out, storage));
  return out;
}

// Per phase, then the terminal one.
using Nodes = std::vector<std::shared_ptr<ActionModelAbstract>>;

std::shared_ptr<ActionModelAbstract> integrated(const TaskFile& task, const std::shared_ptr<DiffModel>& model) {
  switch (task.integrator) {
    case TaskIntegrator::kEuler:
      return std::make_shared<IntegratedActionModelEuler>(model, task.step);
    case TaskIntegrator::kRk2:
      return std::make_shared<IntegratedActionModelRK>(model, RKType::two, task.step);
    case TaskIntegrator::kRk3:
      return std::make_shared<IntegratedActionModelRK>(model, RKType::three, task.step);
    case TaskIntegrator::kRk4:
      return std::make_shared<IntegratedActionModelRK>(model, RKType::four, task.step);
  }
  return nullptr;
}

Nodes nodes_of(const TaskFile& task, const TaskProblem& problem) {
  Nodes out;
  for (std::size_t k = 0; k < task.phases.size(); ++k) out.push_back(integrated(task, problem.models[k]));
  out.push_back(std::make_shared<IntegratedActionModelEuler>(problem.models.back(), 0));
  return out;
}

// Torques of each phase: quasi-static at x0 without its velocity, or zero.
std::vector<Eigen::VectorXd> guess_of(const TaskFile& task, const TaskProblem& problem) {
  Eigen::VectorXd still = task::x0_of(task.scene);
  still.tail(task.scene.scene.nv).setZero();
  std::vector<Eigen::VectorXd> us;
  for (std::size_t k = 0; k < task.phases.size(); ++k) {
    us.emplace_back(Eigen::VectorXd::Zero(static_cast<Eigen::Index>(problem.actuation->get_nu())));
    if (task.guess == TaskGuess::kQuasiStatic && us.back().size() > 0)
      problem.models[k]->quasiStatic(problem.models[k]->createData(), us.back(), still);
  }
  return us;
}

// us: per phase.
void finish(const TaskFile& task, const Nodes& nodes, const std::vector<Eigen::VectorXd>& us, TaskProblem& out) {
  Nodes running;
  for (const int k : phase_of_node(task)) {
    running.push_back(nodes[static_cast<std::size_t>(k)]);
    out.us.push_back(us[static_cast<std::size_t>(k)]);
  }
  const Eigen::VectorXd x0 = task::x0_of(task.scene);
  out.problem = std::make_shared<ShootingProblem>(x0, running, nodes.back());
  out.xs.assign(running.size() + 1, x0);
}

// Nodes and guess of every part, put together.
void finish_by_parts(const TaskFile& task, TaskProblem& out) {
  const std::size_t nu = out.actuation->get_nu(), phases = task.phases.size();
  std::vector<std::vector<ActionPart>> parts(phases + 1);
  std::vector<Eigen::VectorXd> us(phases, Eigen::VectorXd::Zero(static_cast<Eigen::Index>(nu)));
  for (const std::vector<int>& robots : out.parts) {
    const TaskFile own = part_of(task, robots);
    const TaskProblem models = models_of(own, MatrixStorage::kDense);
    const Nodes nodes = nodes_of(own, models);
    const std::vector<Eigen::VectorXd> own_us = guess_of(own, models);
    ActionPart part = coordinates_of(task.scene.scene, robots);
    for (std::size_t k = 0; k <= phases; ++k) {
      part.model = nodes[k];
      parts[k].push_back(part);
      if (k < phases) scatter(own_us[k], part.u, us[k]);
    }
  }
  Nodes nodes;
  for (std::vector<ActionPart>& own : parts) {
    auto model = std::make_shared<ActionModelParts>(out.state, nu, std::move(own));
    model->set_storage(MatrixStorage::kSparse);
    nodes.push_back(std::move(model));
  }
  finish(task, nodes, us, out);
}

}  // namespace

bool has_constraints(const TaskFile& task) {
  return !task.terminal.constraints.empty() ||
         std::any_of(task.phases.begin(), task.phases.end(), [](const TaskPhase& p) { return !p.constraints.empty(); });
}

TaskProblem make_problem(const TaskFile& task, TaskSolver solver) {
  const bool by_parts = (solver == TaskSolver::kSparse || solver == TaskSolver::kAuto) && !has_constraints(task);
  std::vector<std::vector<int>> parts;
  if (by_parts) parts = separate_robots(task);
  if (parts.size() <= 1) return make_problem(task);
  TaskProblem out = models_of(task, MatrixStorage::kSparse);
  out.parts = std::move(parts);
  finish_by_parts(task, out);
  return out;
}

TaskProblem make_problem(const TaskFile& task) {
  TaskProblem out = models_of(task, MatrixStorage::kDense);
  out.parts.emplace_back();
  for (int r = 0; r < task.scene.scene.nrobots(); ++r) out.parts[0].push_back(r);
  finish(task, nodes_of(task, out), guess_of(task, out), out);
  return out;
}

std::vector<int> phase_of_node(const TaskFile& task) {
  std::vector<int> out;
  for (std::size_t k = 0; k < task.phases.size(); ++k)
    out.insert(out.end(), static_cast<std::size_t>(task.phases[k].nodes), static_cast<int>(k));
  return out;
}

}  // namespace manycontact
