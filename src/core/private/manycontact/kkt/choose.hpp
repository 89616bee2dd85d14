#pragma once
// Chooses the method and elimination order of an island by the least predicted cost.

#include <array>
#include <string>

#include "manycontact/kkt/shape.hpp"

namespace manycontact {

/// Predicted costs of one factorization and two solves, fitted (kkt/costs.hpp) to times of chains, trees, combs, hands,
/// nets and ladders of 10 to 1,000 links; mostly within a factor of 1.3. Nearly dependent rows cost more.
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

double predicted_cost_of_terms(int rows, std::size_t contacts);  // PredictedCosts::terms in a SIMD batch

/// Largest number of rows of a robot's K that are solved in a SIMD batch, whose scratch memory must stay in the cache.
inline constexpr int kLargestInLanes = 400;

/// Estimates the cost of sparse-ldl in the cheapest elimination order from the trees' depths.
double least_cost_ldl(const IslandShape& shape);
/// Whether trees are so deep that sparse-bodies is cheaper than least_cost_ldl. Joint-space patterns are not computed
/// for such islands.
bool is_deep(IslandShape& shape);

/// Returns the number of entries of joint-space K, which is not allocated for sparse-bodies above kMostJointSpace.
double joint_space_size(const IslandShape& shape);
inline constexpr double kMostJointSpace = 1 << 22;

/// Chooses what the options leave open: another order than leaf-to-root if clearly cheaper (tolerance::kCheaper),
/// sparse-bodies if cheaper than sparse-ldl, the dense method only for overdetermined islands.
Choice choose(IslandShape& shape, const Options& options);

/// Explains the choice, e.g. "sparse-ldl in leaf-to-root order; camd at 0.95 of its cost is not enough cheaper".
std::string why_chosen(const Choice& choice, const PredictedCosts& costs, const Options& options);

}  // namespace manycontact
