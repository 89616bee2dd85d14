#pragma once
// The condition that errors are judged by: |K|_1 |K^-1|_1, computed here and not by the library's estimate.

#include "stability/island_system.hpp"

namespace manycontact::test {

/// From the whole inverse. Where delta = 0 and J's rank is less than its rows, of the generalised inverse K^+ that is
/// orthogonal to the null space of J^T: |K|_1 |K^+|_1. Infinite where there is none.
double condition(const IslandSystem<Quad>& system, double delta, int rank);

/// A lower bound, nearly always within a factor 3, for systems too large for the whole inverse: by Eigen's LU of K in
/// double and its estimate of |K^-1|_1. J has full rank or delta > 0.
double estimated_condition(const IslandSystem<double>& system, double delta);

}  // namespace manycontact::test
