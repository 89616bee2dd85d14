#include "manycontact/task/forces.hpp"

#include "manycontact/control/euler.hpp"
#include "manycontact/control/rk.hpp"

namespace manycontact {

namespace {

const DifferentialActionDataContactFwdDynamics& dynamics_of(const ActionDataAbstract& data) {
  if (const auto* euler = dynamic_cast<const IntegratedActionDataEuler*>(&data))
    return dynamic_cast<const DifferentialActionDataContactFwdDynamics&>(*euler->differential);
  const auto& rk = dynamic_cast<const IntegratedActionDataRK&>(data);
  return dynamic_cast<const DifferentialActionDataContactFwdDynamics&>(*rk.differential[0]);
}

}  // namespace

std::vector<Eigen::VectorXd> contact_forces(const TaskFile& task, const TaskProblem& problem, std::size_t t) {
  require(t < problem.problem->get_T(), "contact_forces", "a running node is expected");
  const auto& data = dynamics_of(*problem.problem->get_runningDatas()[t]).multibody->contacts->contacts;
  std::vector<Eigen::VectorXd> out;
  for (const Contact& contact : task.scene.scene.contacts) {
    const auto found = data.find(contact.name);
    out.push_back(found == data.end() ? Eigen::VectorXd() : found->second->f);
  }
  return out;
}

}  // namespace manycontact
