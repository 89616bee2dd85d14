#pragma once

#include "manycontact/action/contact_fwddyn.hpp"

namespace manycontact {

/// Forward dynamics without contacts, as in Crocoddyl's DifferentialActionModelFreeFwdDynamics.
class DifferentialActionModelFreeFwdDynamics : public DifferentialActionModelContactFwdDynamics {
 public:
  /// Throws std::invalid_argument if the parts do not belong together.
  DifferentialActionModelFreeFwdDynamics(std::shared_ptr<StateMultibody> state,
                                         std::shared_ptr<ActuationModelAbstract> actuation,
                                         std::shared_ptr<CostModelSum> costs,
                                         std::shared_ptr<ConstraintModelManager> constraints = nullptr)
      : DifferentialActionModelContactFwdDynamics(
            state, actuation, std::make_shared<ContactModelMultiple>(state, actuation ? actuation->get_nu() : 0), costs,
            constraints) {}
};

using DifferentialActionDataFreeFwdDynamics = DifferentialActionDataContactFwdDynamics;

}  // namespace manycontact
