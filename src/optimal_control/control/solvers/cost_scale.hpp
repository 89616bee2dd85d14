#pragma once

#include "manycontact/control/shooting.hpp"

namespace manycontact::internal {

/// Sizes of a problem's cost, from the Hessians at the nodes' last calcDiff.
struct CostScale {
  /// The size of the cost: 1 for Hessians of ordinary size. It differs from 1 if a Hessian of controls is below 1e-6
  /// (too small for an absolute regularisation), or a Hessian is above 1e7 (absolute thresholds are then below rounding
  /// errors). It is a power of two, so that weights times a power of two give the same motion bit for bit.
  double cost = 1;
  /// The unit of gradients, proportional to the cost: sqrt(smallest Hessian of controls * largest Hessian of all).
  double gradient = 1;
};
CostScale cost_scale(const ShootingProblem& problem);

}  // namespace manycontact::internal
