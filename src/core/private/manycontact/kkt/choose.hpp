#pragma once
// Chooses the method and elimination order of an island by the least predicted cost.

#include <array>
#include <string>

#include "manycontact/kkt/shape.hpp"

namespace manycontact {

/// Predicted costs of one factorization and two solves. The coefficients (kkt/costs.hpp) are least-squares fits of the
/// logarithms of times for chains, trees, combs, hands, nets and ladders of 10 to 1,000 links. They are mostly accurate
/// to a factor of 1.3. Nearly dependent rows cost more than predicted.
struct PredictedCosts {
  std::array<double, std::size(kOrders)> ldl, cholmod;  // one cost per elimination order
  double dense;
  double terms;   // the terms of M and J, which all methods above need
  double bodies;  // sparse-bodies, which needs no terms of M and J
};
/// Predicts the costs. For deep trees, which have no joint-space patterns, ldl is least_cost_ldl and cholmod infinity.
PredictedCosts predict_costs(IslandShape& shape);

/// Returns the cost of a factorization and solves by sparse-ldl, in the units of PredictedCosts. rows: of K.
double predicted_cost_ldl(int rows, const sparse::LdlCounts& L);

/// Returns PredictedCosts::terms of an island in a SIMD batch.
double predicted_cost_of_terms(int rows, std::size_t contacts);

/// Largest number of rows of a robot's K that are solved in a SIMD batch, whose scratch memory must stay in the cache.
inline constexpr int kLargestInLanes = 400;

/// Returns the least cost of sparse-ldl in any order, estimated from the trees' depths alone.
double least_cost_ldl(const IslandShape& shape);
/// Whether trees are so deep that sparse-bodies is cheaper than least_cost_ldl. Joint-space patterns are not computed
/// for such islands.
bool is_deep(IslandShape& shape);

/// Returns the number of entries of an island's joint-space K. Above kMostJointSpace, islands solved by sparse-bodies
/// do not allocate K.
double joint_space_size(const IslandShape& shape);
inline constexpr double kMostJointSpace = 1 << 22;

/// Chooses the method and order, as far as the options do not fix them. An order other than leaf-to-root is chosen if
/// it is clearly cheaper (tolerance::kCheaper), and sparse-bodies if it is cheaper than sparse-ldl. kAuto chooses the
/// dense method, which allocates memory, only for overdetermined islands.
Choice choose(IslandShape& shape, const Options& options);

/// Explains the choice, e.g. "sparse-ldl in leaf-to-root order; camd at 0.95 of its cost is not enough cheaper".
std::string why_chosen(const Choice& choice, const PredictedCosts& costs, const Options& options);

}  // namespace manycontact
