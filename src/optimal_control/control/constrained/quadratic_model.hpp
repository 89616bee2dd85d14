#pragma once
// The linear-quadratic problem of a shooting problem's nodes, for the solvers of lq.

#include "manycontact/control/parts.hpp"
#include "manycontact/lq/problem.hpp"

namespace manycontact::internal {

/// Node t where it has couplings, else nullptr.
const ActionModelParts* as_coupled(const ShootingProblem& problem, std::size_t t);
/// The parts of nodes with couplings, the same throughout; of other nodes one, of all coordinates.
std::vector<ActionPart> blocks_of(const ShootingProblem& problem);

/// One group per block, with the couplings that touch it: pairs of blocks, of six rows each.
lq::Knot knot_of(std::size_t blocks, const std::vector<std::pair<int, int>>& couplings);
/// Zeros of the right sizes.
lq::Problem structure_of(const ShootingProblem& problem, const std::vector<ActionPart>& blocks);

enum class Terms { kAll, kWithoutHessians };
/// From the nodes' derivatives: all but f and x0.
void fill_nodes(const ShootingProblem& problem, Terms terms, lq::Problem& out);

}  // namespace manycontact::internal
