#pragma once
// Factorizes M = L^T D L along the tree, leaves first, without fill-in. Source: Featherstone (2008), table 6.3.
//
// The factor has the same packing as M (detail/algorithm/crba.hpp): row k has D_k, then L(k, i) of its ancestors i.

#include <limits>
#include <vector>

#include "manycontact/model/model.hpp"

namespace manycontact {

/// Overwrites M with its factor. Returns the coordinates, ascending, with a pivot of at most `least` times their
/// diagonal entry (by default a rounding error). They are not eliminated; if any, do not solve. diagonal: scratch, nv.
std::vector<int> factorize_inertia(const Model& model, double* M, double* diagonal,
                                   double least = 64 * std::numeric_limits<double>::epsilon());

/// X <- M^-1 X, L^-T X or L^-1 X, if all coordinates were eliminated. X: nv rows of `cols` numbers, row-major.
void solve_inertia(const Model& model, const double* factor, int cols, double* X);
void solve_inertia_transposed(const Model& model, const double* factor, int cols, double* X);
void solve_inertia_unit(const Model& model, const double* factor, int cols, double* X);

}  // namespace manycontact
