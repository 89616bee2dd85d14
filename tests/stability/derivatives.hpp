#pragma once
// Compares derivatives of a solution along a few directions with central differences of the truth.

#include "manycontact/dynamics/data.hpp"
#include "stability/truths.hpp"

namespace manycontact::test {

/// Returns a direction in q, one in v and one in u. There are none if the scene is large, or if J's rank changes
/// nearby, so that no derivatives exist. It uses all of the truths but directions.
std::vector<Direction> true_directions(const Problem& p, const Truths& truths);

/// Errors of the derivatives at the solution in `data` along the directions, except for failed islands.
struct DirectionErrors {
  double largest = 0;  // relative, in the maximum norm, per direction, quantity and robot; NaN if a derivative is
  double excess = 0;   // the same relative to the allowed error: ten times that of a value
};
DirectionErrors direction_errors(const Problem& p, const Truths& truths, SceneData& data);

}  // namespace manycontact::test
