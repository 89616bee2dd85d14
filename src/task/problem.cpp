#include "manycontact/task/problem.hpp"

#include "manycontact/control/euler.hpp"
#include "manycontact/control/rk.hpp"
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
    if (robot.model->floating_base) return std::make_shared<ActuationModelFloatingBase>(state);
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

std::shared_ptr<DiffModel> model_of(const TaskFile& task, const TaskPhase& phase, const TaskProblem& problem) {
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
  model->set_storage(MatrixStorage::kDense);
  blame(task, phase.line, [&] { (void)model->createData(); });
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
  }
  return nullptr;
}

// x0 at every node; torques of each phase, quasi-static at x0 without its velocity, or zero.
void fill_guess(const TaskFile& task, const Eigen::VectorXd& x0, TaskProblem& out) {
  out.xs.assign(out.problem->get_T() + 1, x0);
  Eigen::VectorXd still = x0;
  still.tail(task.scene.scene.nv).setZero();
  for (std::size_t k = 0; k < task.phases.size(); ++k) {
    Eigen::VectorXd u = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(out.actuation->get_nu()));
    if (task.guess == TaskGuess::kQuasiStatic && u.size() > 0)
      out.models[k]->quasiStatic(out.models[k]->createData(), u, still);
    out.us.insert(out.us.end(), static_cast<std::size_t>(task.phases[k].nodes), u);
  }
}

}  // namespace

TaskProblem make_problem(const TaskFile& task) {
  TaskProblem out;
  out.state = std::make_shared<StateMultibody>(task.scene.scene);
  out.actuation = actuation_of(out.state);
  std::vector<std::shared_ptr<ActionModelAbstract>> running;
  for (const TaskPhase& phase : task.phases) {
    out.models.push_back(model_of(task, phase, out));
    running.insert(running.end(), static_cast<std::size_t>(phase.nodes), integrated(task, out.models.back()));
  }
  out.models.push_back(model_of(task, task.terminal, out));
  const auto terminal = std::make_shared<IntegratedActionModelEuler>(out.models.back(), 0);
  Eigen::VectorXd x0(task.scene.scene.nq + task.scene.scene.nv);
  x0 << task.scene.q, task.scene.v;
  out.problem = std::make_shared<ShootingProblem>(x0, running, terminal);
  fill_guess(task, x0, out);
  return out;
}

std::vector<int> phase_of_node(const TaskFile& task) {
  std::vector<int> out;
  for (std::size_t k = 0; k < task.phases.size(); ++k)
    out.insert(out.end(), static_cast<std::size_t>(task.phases[k].nodes), static_cast<int>(k));
  return out;
}

}  // namespace manycontact
