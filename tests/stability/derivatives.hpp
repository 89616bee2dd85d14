#pragma once
// Derivatives of an answer along a few directions, against central differences of the truth.

#include "manycontact/dynamics/data.hpp"
#include "stability/truths.hpp"

namespace manycontact::test {

/// A direction in q, one in v and one in u. None where nothing is known: the scene is large, or there are no
/// derivatives, since J's rank changes nearby. From all of the truths but directions.
std::vector<Direction> true_directions(const Problem& p, const Truths& truths);

/// Errors of the derivatives at the answer in `data` along the directions; not of failed islands.
struct DirectionErrors {
  double largest = 0;  // relative, in the maximum norm, per direction, quantity and robot; NaN when a derivative is
  double excess = 0;   // the same in units of what is allowed it: ten times what is allowed a value
};
DirectionErrors direction_errors(const Problem& p, const Truths& truths, SceneData& data);

}  // namespace manycontact::test
