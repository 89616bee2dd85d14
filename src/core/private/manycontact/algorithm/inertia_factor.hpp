#pragma once
// Factorizes M = L^T D L along the tree, leaves first, without fill-in. Source: Featherstone (2008), table 6.3.
//
// The factor has the same packing as M (detail/algorithm/crba.hpp): row k has D_k, then L(k, i) of its ancestors i.

#include <limits>
#include <vector>

#include "manycontact/model/model.hpp"

namespace manycontact {

/// Overwrites M by its factor. Returns the coordinates, ascending, whose pivot is at most `least` times M's diagonal
/// (default: rounding error). Their elimination is skipped, so that the factor cannot solve. diagonal: scratch, nv.
std::vector<int> factorize_inertia(const Model& model, double* M, double* diagonal,
                                   double least = 64 * std::numeric_limits<double>::epsilon());

/// Overwrite X by M^-1 X, L^-T X or L^-1 X; no pivot may be skipped. X: nv rows of `cols` numbers, row-major.
void solve_inertia(const Model& model, const double* factor, int cols, double* X);
void solve_inertia_transposed(const Model& model, const double* factor, int cols, double* X);
void solve_inertia_unit(const Model& model, const double* factor, int cols, double* X);

}  // namespace manycontact
