#pragma once

#include "manycontact/control/shooting.hpp"

namespace manycontact::internal {

/// The size of a problem's cost, a power of two, by the Hessians at the nodes' last calcDiff: 1 while the controls' are
/// not too small for an absolute regularisation (1e-6), nor any so large (1e7) that absolute thresholds drown in
/// rounding; else what brings them back to an ordinary size. Powers of two, so that weights times such a number give
/// the same bits.
double cost_scale(const ShootingProblem& problem);

}  // namespace manycontact::internal
