#pragma once
// Makes the linear-quadratic problem (lq/problem.hpp) around the candidate of a shooting problem.

#include "manycontact/detail/control/parts.hpp"
#include "manycontact/lq/problem.hpp"

namespace manycontact::internal {

/// Returns the model of node t if the node has couplings, otherwise null.
const ActionModelParts* as_coupled(const ShootingProblem& problem, std::size_t t);
/// Returns the subproblems of coupled nodes, which are the same in all nodes. Without couplings, there is one
/// subproblem with all coordinates.
std::vector<ActionPart> blocks_of(const ShootingProblem& problem);

/// Makes a knot with one group per block. couplings: pairs of blocks. Each coupling has six rows and six variables.
lq::Knot knot_of(std::size_t blocks, const std::vector<std::pair<int, int>>& couplings);
/// Makes the linear-quadratic problem with all matrices and vectors zero.
lq::Problem structure_of(const ShootingProblem& problem, const std::vector<ActionPart>& blocks);

enum class Terms { kAll, kWithoutHessians };
/// Sets all matrices and vectors except f and x0 from the nodes' derivatives.
void fill_nodes(const ShootingProblem& problem, Terms terms, lq::Problem& out);

}  // namespace manycontact::internal
