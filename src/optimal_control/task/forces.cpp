#include "manycontact/task/forces.hpp"

#include <map>

#include "manycontact/control/impulse_fwddyn.hpp"
#include "manycontact/control/integrated_action.hpp"
#include "manycontact/detail/control/couplings.hpp"

namespace manycontact {

namespace {

using Forces = std::map<std::string, Eigen::VectorXd>;

// Collects contact forces by name, in all subproblems of a node. Impacts are skipped, because they have impulses.
void collect(const ActionModelAbstract& model, const ActionDataAbstract& data, Forces& out) {
  if (dynamic_cast<const ActionDataImpulseFwdDynamics*>(&data)) return;
  if (const auto* whole = dynamic_cast<const ActionDataParts*>(&data)) {
    const auto& node = static_cast<const ActionModelParts&>(model);
    for (std::size_t i = 0; i < whole->parts.size(); ++i) collect(*node.get_parts()[i].model, *whole->parts[i], out);
    const Couplings* couplings = node.get_couplings().get();
    for (std::size_t b = 0; couplings && b < couplings->couplings().size(); ++b)
      out[couplings->name(b)] = couplings->force(b, *whole->couplings);
    return;
  }
  const IntegratorStage first = dynamic_cast<const IntegratedActionDataAbstract&>(data).stage(0);
  const auto& own = dynamic_cast<const DifferentialActionDataContactFwdDynamics&>(*first.differential);
  for (const auto& [name, contact] : own.multibody->contacts->contacts) out[name] = contact->f;
}

}  // namespace

std::vector<Eigen::VectorXd> contact_forces(const TaskFile& task, const TaskProblem& problem, std::size_t t) {
  require(t < problem.problem->get_T(), "contact_forces", "a running node is expected");
  Forces forces;
  collect(*problem.problem->model(t), *problem.problem->data(t), forces);
  std::vector<Eigen::VectorXd> out;
  for (const Contact& contact : task.scene.scene.contacts) {
    const auto found = forces.find(contact.name);
    out.push_back(found == forces.end() ? Eigen::VectorXd() : found->second);
  }
  return out;
}

}  // namespace manycontact
