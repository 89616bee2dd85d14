#pragma once

#include "manycontact/control/shooting.hpp"

namespace manycontact::internal {

/// The size of a problem's cost, a power of two, from the Hessians at the nodes' last calcDiff. It is 1 as long as the
/// Hessians of controls are not too small for an absolute regularisation (1e-6), and none is so large (1e7) that
/// absolute thresholds are below rounding errors. Otherwise it scales them to an ordinary size. Powers of two give the
/// same bits for weights multiplied by such a number.
double cost_scale(const ShootingProblem& problem);

}  // namespace manycontact::internal
