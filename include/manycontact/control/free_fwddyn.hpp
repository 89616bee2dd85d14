#pragma once
// Forward dynamics without contacts. Crocoddyl's DifferentialActionModelFreeFwdDynamics.

#include "manycontact/action/contact_fwddyn.hpp"

namespace manycontact {

/// Forward dynamics without contacts.
class DifferentialActionModelFreeFwdDynamics : public DifferentialActionModelContactFwdDynamics {
 public:
  /// Throws std::invalid_argument if the parts do not belong together.
  DifferentialActionModelFreeFwdDynamics(std::shared_ptr<StateMultibody> state,
                                         std::shared_ptr<ActuationModelAbstract> actuation,
                                         std::shared_ptr<CostModelSum> costs,
                                         std::shared_ptr<ConstraintModelManager> constraints = nullptr);
};

using DifferentialActionDataFreeFwdDynamics = DifferentialActionDataContactFwdDynamics;

}  // namespace manycontact
