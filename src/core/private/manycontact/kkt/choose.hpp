#pragma once
// Chooses the method and the order that solve an island at the least predicted cost.

#include <array>
#include <string>

#include "manycontact/kkt/shape.hpp"

namespace manycontact {

/// Predicted costs of one factorization and two solves. Coefficients of sparse-ldl and sparse-bodies by least squares
/// of the logarithms of times, measured over chains, trees, combs, hands, nets and ladders of 10 to 1,000 links one by
/// one; most within 1.3. Nearly dependent rows take longer.
struct PredictedCosts {
  std::array<double, std::size(kOrders)> ldl, cholmod;  // one cost per order
  double dense;
  double terms;   // cost of the terms of M and J, which all these need ...
  double bodies;  // ... but not sparse-bodies
};
/// Predicts the costs. Deep trees have no joint-space pattern: ldl is least_cost_ldl, cholmod infinite.
PredictedCosts predict_costs(IslandShape& shape);

/// The cost of a factor by sparse-ldl, in the units of PredictedCosts.
double predicted_cost_ldl(int rows, const sparse::LdlCounts& L);

/// The part for terms, of an island in a SIMD batch.
double predicted_cost_of_terms(int rows, std::size_t contacts);

/// Rows of a robot's K in a SIMD batch, at most: the scratch memory of a batch stays in the caches.
inline constexpr int kLargestInLanes = 400;

/// Least cost of sparse-ldl in any order, from the trees' depths alone.
double least_cost_ldl(const IslandShape& shape);
/// Whether sparse-bodies is cheaper than least_cost_ldl. Then the choice does not compute the patterns of the
/// joint-space K.
bool is_deep(IslandShape& shape);

/// Numbers in the joint-space K of an island's contacts and trees. Beyond kMostJointSpace it is not made for an island
/// that sparse-bodies refused, nor are derivatives' terms.
double joint_space_size(const IslandShape& shape);
inline constexpr double kMostJointSpace = 1 << 22;

/// Chooses what the options leave open: another order than leaf-to-root where it is clearly cheaper
/// (tolerance::kCheaper), sparse-bodies where it is cheaper than sparse-ldl. kAuto takes the dense method for
/// overdetermined islands alone: it allocates, and is cheaper on islands of a few coordinates at most.
Choice choose(IslandShape& shape, const Options& options);

/// "sparse-ldl in leaf-to-root order; camd at 0.95 of its cost is not enough cheaper": the reason of the choice.
std::string why_chosen(const Choice& choice, const PredictedCosts& costs, const Options& options);

}  // namespace manycontact
