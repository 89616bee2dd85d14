#pragma once
// Derivatives of a solution along a few directions are compared with central differences of the truth.

#include "manycontact/dynamics/data.hpp"
#include "stability/truths.hpp"

namespace manycontact::test {

/// Returns a direction in q, one in v and one in u. There are none if nothing is known: the scene is large, or no
/// derivatives exist, since J's rank changes nearby. It uses all of the truths but directions.
std::vector<Direction> true_directions(const Problem& p, const Truths& truths);

/// Errors of the derivatives at the solution in `data` along the directions, except for failed islands.
struct DirectionErrors {
  double largest = 0;  // relative, in the maximum norm, per direction, quantity and robot; NaN when a derivative is
  double excess = 0;   // the same relative to the allowed error: ten times that of a value
};
DirectionErrors direction_errors(const Problem& p, const Truths& truths, SceneData& data);

}  // namespace manycontact::test
