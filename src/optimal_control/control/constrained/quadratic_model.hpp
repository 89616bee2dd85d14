#pragma once
// The linear-quadratic problem of a shooting problem's nodes, for the solvers of lq.

#include "manycontact/detail/control/parts.hpp"
#include "manycontact/lq/problem.hpp"

namespace manycontact::internal {

/// Returns node t if it has couplings, else nullptr.
const ActionModelParts* as_coupled(const ShootingProblem& problem, std::size_t t);
/// Returns the subproblems of nodes with couplings, equal in all nodes; other nodes have one, with all coordinates.
std::vector<ActionPart> blocks_of(const ShootingProblem& problem);

/// Makes one group per block, with the couplings (pairs of blocks, six rows each) that contain the block.
lq::Knot knot_of(std::size_t blocks, const std::vector<std::pair<int, int>>& couplings);
/// Makes the problem with zeros of the right sizes.
lq::Problem structure_of(const ShootingProblem& problem, const std::vector<ActionPart>& blocks);

enum class Terms { kAll, kWithoutHessians };
/// Sets all but f and x0 from the nodes' derivatives.
void fill_nodes(const ShootingProblem& problem, Terms terms, lq::Problem& out);

}  // namespace manycontact::internal
