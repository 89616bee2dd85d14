#pragma once
// The condition that errors are judged by: |K|_1 |K^-1|_1, computed here and not by the library's estimate.

#include "stability/island_system.hpp"

namespace manycontact::test {

struct Condition {
  double K = 0, inverse = 0;  // 1-norms
  double product() const { return K * inverse; }
};

/// From the whole inverse. Where delta = 0 and J's rank is less than its rows, of the generalised inverse K^+ that is
/// orthogonal to the null space of J^T. Infinite where there is none.
Condition condition(const IslandSystem<Quad>& system, double delta, int rank);

/// A lower bound, nearly always within a factor 3, for systems too large for the whole inverse: by Eigen's LU of K in
/// double and its estimate of |K^-1|_1. J has full rank or delta > 0.
Condition estimated_condition(const IslandSystem<double>& system, double delta);

}  // namespace manycontact::test
