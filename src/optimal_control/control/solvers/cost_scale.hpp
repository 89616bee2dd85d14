#pragma once

#include "manycontact/control/shooting.hpp"

namespace manycontact::internal {

/// Sizes of a problem's cost, from the Hessians at the nodes' last calcDiff.
struct CostScale {
  /// A power of two: weights times a power of two then give the same motion, bit for bit. It is 1 as long as the
  /// Hessians of controls are not too small for an absolute regularisation (1e-6), and none is so large (1e7) that
  /// absolute thresholds are below rounding errors. Otherwise it scales them to an ordinary size.
  double cost = 1;
  /// The unit of gradients, proportional to the cost: sqrt(smallest Hessian of controls * largest Hessian of all).
  double gradient = 1;
};
CostScale cost_scale(const ShootingProblem& problem);

}  // namespace manycontact::internal
