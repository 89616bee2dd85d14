#pragma once
// Makes the linear-quadratic problem (lq/problem.hpp) around the candidate of a shooting problem.

#include "manycontact/detail/control/parts.hpp"
#include "manycontact/lq/problem.hpp"

namespace manycontact::internal {

const ActionModelParts* as_coupled(const ShootingProblem& problem, std::size_t t);  // model of node t, or null
/// Returns the subproblems of coupled nodes, the same in all nodes, or, without couplings, one with all coordinates.
std::vector<ActionPart> blocks_of(const ShootingProblem& problem);

/// Makes a knot with one group per block. couplings: pairs of blocks. Each coupling has six rows and six variables.
lq::Knot knot_of(std::size_t blocks, const std::vector<std::pair<int, int>>& couplings);
/// Makes the linear-quadratic problem with all matrices and vectors zero.
lq::Problem structure_of(const ShootingProblem& problem, const std::vector<ActionPart>& blocks);

enum class Terms { kAll, kWithoutHessians };
void fill_nodes(const ShootingProblem& problem, Terms terms, lq::Problem& out);

}  // namespace manycontact::internal
