#include "manycontact/control/free_fwddyn.hpp"

namespace manycontact {

namespace {

std::shared_ptr<ContactModelMultiple> no_contacts(const std::shared_ptr<StateMultibody>& state,
                                                  const std::shared_ptr<ActuationModelAbstract>& actuation) {
  return std::make_shared<ContactModelMultiple>(state, actuation ? actuation->get_nu() : 0);
}

}  // namespace

DifferentialActionModelFreeFwdDynamics::DifferentialActionModelFreeFwdDynamics(
    std::shared_ptr<StateMultibody> state, std::shared_ptr<ActuationModelAbstract> actuation,
    std::shared_ptr<CostModelSum> costs, std::shared_ptr<ConstraintModelManager> constraints)
    : DifferentialActionModelContactFwdDynamics(state, actuation, no_contacts(state, actuation), costs, constraints) {}

}  // namespace manycontact
