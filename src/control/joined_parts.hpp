#pragma once
// What the parts' data of joined nodes are.

#include "manycontact/control/augmented_action.hpp"
#include "manycontact/control/euler.hpp"

namespace manycontact::internal {

/// Of a part that may be within an augmented Lagrangian.
inline IntegratedActionDataEuler& euler_of(ActionDataAbstract& part) {
  auto* augmented = dynamic_cast<ActionDataAugmentedLagrangian*>(&part);
  return static_cast<IntegratedActionDataEuler&>(augmented ? *augmented->inner : part);
}

}  // namespace manycontact::internal
