#pragma once
// Which method and order solve an island at the least predicted cost.

#include <array>
#include <string>

#include "manycontact/kkt/shape.hpp"

namespace manycontact {

/// Predicted costs of one factorization and two solves. Relative: coefficients by measured factors, of which a row, an
/// entry of L and a multiply-add of sparse LDL cost 17, 20 and 0.3; only ratios mean something, to a factor of two.
struct PredictedCosts {
  std::array<double, std::size(kOrders)> ldl, cholmod;  // in each order
  double supernodal;                                    // infinite where it is not built in or there are no contacts
  double bodies;
  double with_terms;  // the least of sparse-ldl with M's terms, which `bodies` is compared with
  double dense;
};
/// Of deep trees, whose joint-space patterns are not made, ldl is least_cost_ldl and cholmod, supernodal are infinite.
PredictedCosts predict_costs(IslandShape& shape);

double predicted_cost_ldl(int rows, const sparse::LdlCounts& L);
double predicted_cost_supernodal(IslandShape& shape);
double predicted_cost_bodies(IslandShape& shape);
double predicted_cost_dense(int nv, int nc);

/// What sparse-ldl costs at least in any order, from the trees' depths alone.
double least_cost_ldl(const IslandShape& shape);
/// Whether sparse-bodies is cheaper than that: then the patterns of the joint-space K are not made to choose.
bool is_deep(IslandShape& shape);

/// Numbers in the joint-space K of an island's contacts and trees. Beyond kMostJointSpace it is not made for an island
/// that sparse-bodies refused, nor are derivatives' terms.
double joint_space_size(const IslandShape& shape);
inline constexpr double kMostJointSpace = 1 << 22;

/// What the options leave open is chosen: another order than leaf-to-root where it is clearly cheaper
/// (tolerance::kCheaper), sparse-supernodal where it is cheaper than sparse-ldl. kAuto never takes a dense method:
/// these allocate, and are cheaper on islands of a few coordinates at most.
Choice choose(IslandShape& shape, const Options& options);

/// "sparse-ldl in leaf-to-root order, at 0.4 of sparse-supernodal's predicted cost": what the choice rests on.
std::string why_chosen(const Choice& choice, const PredictedCosts& costs, const Options& options);

}  // namespace manycontact
