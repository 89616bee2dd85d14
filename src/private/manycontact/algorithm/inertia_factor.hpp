#pragma once
// M = L^T D L along the tree, leaves first: nothing fills in. Featherstone (2008), table 6.3.
//
// Packed as M is (algorithm/crba.hpp): row k has D_k, then L(k, i) of its ancestors i.

#include <vector>

#include "manycontact/model/model.hpp"

namespace manycontact {

/// In the place of M. Returns the coordinates, ascending, whose pivot is no more than rounding of M's diagonal; they
/// are passed over, and what is solved with the factor then means nothing. diagonal: nv numbers, scratch.
std::vector<int> factorize_inertia(const Model& model, double* M, double* diagonal);

/// X <- M^-1 X with a factor without such pivots. X: nv rows of `cols` numbers, one after the other.
void solve_inertia(const Model& model, const double* factor, int cols, double* X);

}  // namespace manycontact
