#pragma once
// M = L^T D L along the tree, leaves first: nothing fills in. Featherstone (2008), table 6.3.
//
// Packed as M is (detail/algorithm/crba.hpp): row k has D_k, then L(k, i) of its ancestors i.

#include <limits>
#include <vector>

#include "manycontact/model/model.hpp"

namespace manycontact {

/// Overwrites M. Returns the coordinates, ascending, whose pivot is at most `least` times M's diagonal, initially the
/// rounding error of that diagonal. These coordinates are passed over, and the factor must not be used for solves.
/// diagonal: nv numbers, scratch.
std::vector<int> factorize_inertia(const Model& model, double* M, double* diagonal,
                                   double least = 64 * std::numeric_limits<double>::epsilon());

/// X <- M^-1 X, L^-T X and L^-1 X, with a factor without such pivots. X: nv rows of `cols` numbers, one after the
/// other.
void solve_inertia(const Model& model, const double* factor, int cols, double* X);
void solve_inertia_transposed(const Model& model, const double* factor, int cols, double* X);
void solve_inertia_unit(const Model& model, const double* factor, int cols, double* X);

}  // namespace manycontact
