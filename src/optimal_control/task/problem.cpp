#include "manycontact/task/problem.hpp"

#include <algorithm>

#include "manycontact/control/euler.hpp"
#include "manycontact/control/impulse_fwddyn.hpp"
#include "manycontact/control/rk.hpp"
#include "manycontact/control/symplectic.hpp"
#include "manycontact/dynamics/quasi_static.hpp"
#include "manycontact/task/joined.hpp"
#include "manycontact/task/parts.hpp"
#include "memory.hpp"
#include "nodes.hpp"

namespace manycontact {

using task::Nodes;

namespace {

// Calls f. A std::invalid_argument of action models becomes an InputError at the given line of the task file.
template <class F>
void blame(const TaskFile& task, int line, const F& f) {
  try {
    f();
  } catch (const std::invalid_argument& error) {
    throw InputError(task.path, line, error.what());
  }
}

std::shared_ptr<ContactModelMultiple> contacts_of(const TaskFile& task, const TaskPhase& phase,
                                                  const std::shared_ptr<StateMultibody>& state, std::size_t nu) {
  const auto& contacts = task.scene.scene.contacts;
  auto out = std::make_shared<ContactModelMultiple>(state, nu);
  for (std::size_t c = 0; c < contacts.size(); ++c)
    if (phase.active[c]) {
      Contact contact = contacts[c];
      if (task::holds_where_it_closed(task, phase, c)) contact.alpha = 0;
      out->addContact(contact.name, std::make_shared<ContactModelOfScene>(state, contact, nu));
    }
  return out;
}

}  // namespace

namespace task {

bool holds_where_it_closed(const TaskFile& task, const TaskPhase& phase, std::size_t contact) {
  std::size_t k = 0;  // number of the phase; the terminal node has the last phase's contacts
  while (k + 1 < task.phases.size() && &task.phases[k] != &phase) ++k;
  while (k > 0 && task.phases[k - 1].active[contact]) --k;
  return k > 0 && !task.phases[k].at_scene;
}

std::shared_ptr<ActuationModelAbstract> actuation_of(const std::shared_ptr<StateMultibody>& state) {
  for (const Robot& robot : state->get_model()->scene().robots)
    if (robot.model->nu() < robot.model->nv) return std::make_shared<ActuationModelFloatingBase>(state);
  return std::make_shared<ActuationModelFull>(state);
}

std::shared_ptr<DiffModel> model_of(const TaskFile& task, const TaskPhase& phase,
                                    const std::shared_ptr<StateMultibody>& state,
                                    const std::shared_ptr<ActuationModelAbstract>& actuation, MatrixStorage storage) {
  const Parts parts{task, state, actuation, contacts_of(task, phase, state, actuation->get_nu())};
  auto costs = std::make_shared<CostModelSum>(state, parts.nu());
  for (const TaskTerm& term : phase.costs) blame(task, term.line, [&] { add_cost(term, parts, *costs); });
  std::shared_ptr<ConstraintModelManager> constraints;
  if (!phase.constraints.empty()) {
    constraints = std::make_shared<ConstraintModelManager>(state, parts.nu());
    for (const TaskTerm& term : phase.constraints)
      blame(task, term.line, [&] { add_constraint(term, parts, *constraints); });
  }
  auto model =
      std::make_shared<DiffModel>(state, actuation, parts.contacts, costs, constraints, task.scene.scene.damping);
  model->set_storage(storage);
  if (!phase.wrenches.empty()) model->set_wrenches(phase.wrenches);
  if (const Eigen::VectorXd x0 = x0_of(task.scene); dependent_rows(scene_in(task, phase), x0) > 0) model->set_start(x0);
  return model;
}

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
    case TaskIntegrator::kSymplectic:
      return std::make_shared<IntegratedActionModelSymplectic>(model, task.step);
  }
  return nullptr;
}

std::shared_ptr<ActionModelAbstract> terminal_of(const std::shared_ptr<DiffModel>& model) {
  return std::make_shared<IntegratedActionModelEuler>(model, 0);
}

Scene scene_with(const TaskFile& task, const std::vector<bool>& active) {
  Scene scene = task.scene.scene;
  for (std::size_t c = 0; c < scene.contacts.size(); ++c) scene.contacts[c].active = active[c];
  return scene;
}

Scene scene_in(const TaskFile& task, const TaskPhase& phase) {
  Scene scene = scene_with(task, phase.active);
  for (std::size_t k = 0; k < phase.wrenches.size(); ++k) scene.wrenches[k].wrench = phase.wrenches[k];
  return scene;
}

std::vector<Eigen::VectorXd> guess_of(const TaskFile& task) {
  const int nu = task.scene.scene.nu;
  std::vector<Eigen::VectorXd> us;
  for (const TaskPhase& phase : task.phases) {
    us.emplace_back(Eigen::VectorXd::Zero(nu));
    if (task.guess != TaskGuess::kQuasiStatic || nu == 0) continue;
    us.back() = quasi_static(scene_in(task, phase), task.scene.q);
  }
  return us;
}

}  // namespace task

namespace {

// Makes state, actuation and differential models, with kSparse only for inspection: nodes use a model per subproblem.
TaskProblem models_of(const TaskFile& task, MatrixStorage storage) {
  TaskProblem out;
  out.state = std::make_shared<StateMultibody>(task.scene.scene);
  out.actuation = task::actuation_of(out.state);
  const auto add = [&](const TaskPhase& phase) {
    out.models.push_back(task::model_of(task, phase, out.state, out.actuation, storage));
    if (storage != MatrixStorage::kSparse) blame(task, phase.line, [&] { (void)out.models.back()->createData(); });
  };
  for (const TaskPhase& phase : task.phases) add(phase);
  add(task.terminal);
  return out;
}

// Returns the constraints of phase `before` on its last state, or null if none depends on the state alone.
std::shared_ptr<ConstraintModelManager> constraints_of(const TaskFile& task, const TaskPhase& before,
                                                       const std::shared_ptr<StateMultibody>& state) {
  const task::Parts parts{task, state, nullptr, nullptr};
  auto out = std::make_shared<ConstraintModelManager>(state, 0);
  for (const TaskTerm& term : before.constraints)
    if (of_state_alone(term.residual)) task::add_constraint(term, parts, *out);
  return out->get_constraints().empty() ? nullptr : out;
}

// Makes the impact between two phases, with the constraints on the state of the first phase.
std::shared_ptr<ActionModelAbstract> impact_of(const TaskFile& task, const TaskPhase& before, const TaskPhase& phase,
                                               const std::shared_ptr<StateMultibody>& state) {
  const Scene& scene = task.scene.scene;
  auto impulses = std::make_shared<ImpulseModelMultiple>(state);
  for (std::size_t c = 0; c < scene.contacts.size(); ++c)
    if (phase.active[c])
      impulses->addImpulse(scene.contacts[c].name, std::make_shared<ImpulseModelOfScene>(state, scene.contacts[c]));
  return std::make_shared<ActionModelImpulseFwdDynamics>(state, impulses, std::make_shared<CostModelSum>(state, 0),
                                                         constraints_of(task, before, state), 0.0, scene.damping);
}

Nodes nodes_of(const TaskFile& task, const TaskProblem& problem) {
  Nodes out;
  for (std::size_t k = 0; k < task.phases.size(); ++k) {
    out.phases.push_back(task::integrated(task, problem.models[k]));
    out.impacts.push_back(task.phases[k].impact ? impact_of(task, task.phases[k - 1], task.phases[k], problem.state)
                                                : nullptr);
  }
  out.terminal = task::terminal_of(problem.models.back());
  return out;
}

// Divides a part's robots into blocks if couplings permit this and, with kAuto, if directions take fewer operations.
std::vector<std::vector<int>> blocks_of(const TaskFile& part, TaskSolver solver) {
  std::vector<std::vector<int>> blocks;
  if (solver != TaskSolver::kBoxFddp) blocks = divide_robots(part);
  if (blocks.size() > 1 && (solver == TaskSolver::kSparse || blocks_are_cheaper(part, blocks)) &&
      couplings_are_independent(part, blocks))
    return blocks;
  return {internal::range(0, part.scene.scene.nrobots())};
}

// Makes the shooting problem from the nodes. us: guess of the torques, one vector per phase.
void finish(const TaskFile& task, const Nodes& nodes, const std::vector<Eigen::VectorXd>& us, TaskProblem& out) {
  ShootingProblem::Models running;
  for (std::size_t k = 0; k < task.phases.size(); ++k) {
    if (task.phases[k].impact) running.push_back(nodes.impacts[k]);
    running.insert(running.end(), static_cast<std::size_t>(task.phases[k].nodes), nodes.phases[k]);
  }
  task::require_memory(task, running);
  for (std::size_t k = 0; k < task.phases.size(); ++k) {
    if (task.phases[k].impact) out.us.emplace_back(0);
    out.us.insert(out.us.end(), static_cast<std::size_t>(task.phases[k].nodes), us[k]);
  }
  const Eigen::VectorXd x0 = task::x0_of(task.scene);
  out.problem = std::make_shared<ShootingProblem>(x0, running, nodes.terminal);
  out.xs.assign(running.size() + 1, x0);
}

struct Part {  // a part of the scene: its robots, and the blocks of these robots (as indices within the part)
  std::vector<int> robots;
  TaskFile task;
  std::vector<std::vector<int>> blocks;
};

std::vector<Part> parts_of(const TaskFile& task, TaskSolver solver) {
  std::vector<Part> out;
  for (std::vector<int>& robots : separate_robots(task)) {
    TaskFile own = part_of(task, robots);
    std::vector<std::vector<int>> blocks = blocks_of(own, solver);
    out.push_back({std::move(robots), std::move(own), std::move(blocks)});
  }
  return out;
}

// Makes one node, an ActionModelParts, of all parts. The node of an impact has no controls.
std::shared_ptr<ActionModelAbstract> together(const TaskProblem& problem, std::vector<ActionPart> parts) {
  std::size_t nu = 0;
  for (const ActionPart& part : parts) nu += part.u.size();
  auto out = std::make_shared<ActionModelParts>(problem.state, nu, std::move(parts));
  out->set_storage(MatrixStorage::kSparse);
  return out;
}

// Returns the storage of a part's nodes. It is kPanel for one robot with torques, Euler, and no constraints.
MatrixStorage storage_of(const TaskFile& part) {
  const Scene& scene = part.scene.scene;
  const bool panel =
      scene.nrobots() == 1 && scene.nu > 0 && part.integrator == TaskIntegrator::kEuler && !has_constraints(part);
  return panel ? MatrixStorage::kPanel : MatrixStorage::kDense;
}

// Makes the nodes and the guess of every part, and combines the nodes to ActionModelParts of the whole scene.
void finish_by_parts(const TaskFile& task, const std::vector<Part>& parts, TaskProblem& out) {
  const std::size_t phases = task.phases.size();
  std::vector<std::vector<ActionPart>> of_phases(phases), of_impacts(phases);
  std::vector<ActionPart> of_terminal;
  std::vector<Eigen::VectorXd> us(phases, Eigen::VectorXd::Zero(task.scene.scene.nu));
  for (const Part& own : parts) {
    const Nodes nodes = own.blocks.size() > 1 ? task::joined_nodes(own.task, own.blocks)
                                              : nodes_of(own.task, models_of(own.task, storage_of(own.task)));
    const std::vector<Eigen::VectorXd> own_us = task::guess_of(own.task);
    ActionPart part = coordinates_of(task.scene.scene, own.robots);
    const auto add = [&part](const std::shared_ptr<ActionModelAbstract>& model, std::vector<ActionPart>& to) {
      to.push_back(part);
      to.back().model = model;
      if (model->get_nu() == 0) to.back().u.clear();
    };
    for (std::size_t k = 0; k < phases; ++k) {
      add(nodes.phases[k], of_phases[k]);
      if (nodes.impacts[k]) add(nodes.impacts[k], of_impacts[k]);
      scatter(own_us[k], part.u, us[k]);
    }
    add(nodes.terminal, of_terminal);
    out.parts.push_back(own.robots);
    for (const std::vector<int>& block : own.blocks) {
      out.blocks.emplace_back();
      for (const int r : block) out.blocks.back().push_back(own.robots[r]);
    }
  }
  Nodes nodes;
  for (std::size_t k = 0; k < phases; ++k) {
    nodes.phases.push_back(together(out, std::move(of_phases[k])));
    nodes.impacts.push_back(task.phases[k].impact ? together(out, std::move(of_impacts[k])) : nullptr);
  }
  nodes.terminal = together(out, std::move(of_terminal));
  finish(task, nodes, us, out);
}

}  // namespace

bool has_constraints(const TaskFile& task) {
  return !task.terminal.constraints.empty() ||
         std::any_of(task.phases.begin(), task.phases.end(), [](const TaskPhase& p) { return !p.constraints.empty(); });
}

namespace {

TaskProblem problem_of_whole(const TaskFile& task) {
  TaskProblem out = models_of(task, MatrixStorage::kDense);
  out.parts = {internal::range(0, task.scene.scene.nrobots())};
  out.blocks = out.parts;
  finish(task, nodes_of(task, out), task::guess_of(task), out);
  return out;
}

}  // namespace

TaskProblem make_problem(const TaskFile& task, TaskSolver solver) {
  std::vector<Part> parts;
  if (solver != TaskSolver::kFddp) parts = parts_of(task, solver);
  if (parts.empty() || (parts.size() == 1 && parts[0].blocks.size() == 1)) return problem_of_whole(task);
  TaskProblem out = models_of(task, MatrixStorage::kSparse);
  finish_by_parts(task, parts, out);
  return out;
}

TaskProblem make_problem(const TaskFile& task) { return make_problem(task, task.solver); }

std::vector<TaskNode> timeline(const TaskFile& task) {
  std::vector<TaskNode> out;
  int steps = 0;
  for (std::size_t k = 0; k < task.phases.size(); ++k) {
    const int phase = static_cast<int>(k);
    if (task.phases[k].impact) out.push_back({phase, true, steps * task.step});
    for (int i = 0; i < task.phases[k].nodes; ++i) out.push_back({phase, false, steps++ * task.step});
  }
  out.push_back({static_cast<int>(task.phases.size()), false, steps * task.step});
  return out;
}

const TaskPhase& phase_at(const TaskFile& task, const TaskNode& node) {
  const std::size_t k = static_cast<std::size_t>(node.phase);
  return k < task.phases.size() ? task.phases[k] : task.terminal;
}

}  // namespace manycontact
