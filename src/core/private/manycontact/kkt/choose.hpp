#pragma once
// Chooses the method and elimination order of an island by the least predicted cost.

#include <array>
#include <string>

#include "manycontact/kkt/shape.hpp"

namespace manycontact {

/// Predicted costs of one factorization and two solves. Coefficients are least-squares fits of log times on chains,
/// trees, combs, hands, nets and ladders of 10 to 1,000 links, mostly within a factor of 1.3; nearly dependent rows
/// cost more.
struct PredictedCosts {
  std::array<double, std::size(kOrders)> ldl, cholmod;  // one cost per order
  double dense;
  double terms;   // cost of the terms of M and J, which all of these need
  double bodies;  // sparse-bodies, which does not need them
};
/// Predicts the costs. Deep trees have no joint-space pattern: ldl is least_cost_ldl, cholmod infinite.
PredictedCosts predict_costs(IslandShape& shape);

/// Returns the cost of a factor by sparse-ldl, in the units of PredictedCosts.
double predicted_cost_ldl(int rows, const sparse::LdlCounts& L);

/// Returns its part for terms, for an island in a SIMD batch.
double predicted_cost_of_terms(int rows, std::size_t contacts);

/// Largest number of rows of a robot's K in a SIMD batch, so that the batch's scratch memory stays in cache.
inline constexpr int kLargestInLanes = 400;

/// Returns the least cost of sparse-ldl in any order, from the trees' depths alone.
double least_cost_ldl(const IslandShape& shape);
/// Whether sparse-bodies is cheaper than least_cost_ldl; patterns of the joint-space K are then not computed.
bool is_deep(IslandShape& shape);

/// Returns the number of entries of an island's joint-space K; above kMostJointSpace sparse-bodies does not allocate
/// it.
double joint_space_size(const IslandShape& shape);
inline constexpr double kMostJointSpace = 1 << 22;

/// Chooses what the options leave open: another order than leaf-to-root if clearly cheaper (tolerance::kCheaper),
/// sparse-bodies if cheaper than sparse-ldl. kAuto chooses the dense method, which allocates, only for overdetermined
/// islands.
Choice choose(IslandShape& shape, const Options& options);

/// Explains the choice, e.g. "sparse-ldl in leaf-to-root order; camd at 0.95 of its cost is not enough cheaper".
std::string why_chosen(const Choice& choice, const PredictedCosts& costs, const Options& options);

}  // namespace manycontact
