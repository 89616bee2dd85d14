#pragma once

#include "manycontact/control/shooting.hpp"

namespace manycontact::internal {

struct CostScale {  // sizes of a problem's cost, determined from the Hessians at the last calcDiff of the nodes
  /// The size of the cost, which is 1 for Hessians of ordinary size. It differs from 1 if a Hessian of controls is
  /// below 1e-6 (too small for an absolute regularisation), or if a Hessian is above 1e7 (absolute thresholds are then
  /// below rounding errors). It is a power of two, so that weights times a power of two give exactly the same motion.
  double cost = 1;
  double gradient = 1;  // unit of gradients, proportional to the cost: sqrt(smallest control Hessian * largest Hessian)
};
CostScale cost_scale(const ShootingProblem& problem);

}  // namespace manycontact::internal
