#pragma once
// The condition |K|_1 |K^-1|_1, to which errors are relative, computed here and not with the library's estimate.

#include "stability/island_system.hpp"

namespace manycontact::test {

struct Condition {
  double K = 0, inverse = 0;  // 1-norms
  double product() const { return K * inverse; }
};

/// Computes the condition from the whole inverse, or, if delta = 0 and rows of J are dependent, from the generalised
/// inverse K^+ that is orthogonal to the null space of J^T. It is infinite if there is no inverse.
Condition condition(const IslandSystem<Quad>& system, double delta, int rank);

/// Returns a lower bound, nearly always within a factor 3, for systems too large for the whole inverse, from Eigen's LU
/// of K in double and its estimate of |K^-1|_1. J has full rank or delta > 0.
Condition estimated_condition(const IslandSystem<double>& system, double delta);

}  // namespace manycontact::test
