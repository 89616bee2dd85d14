#pragma once
#include <vector>

#include "manycontact/sparse/upper_csc.hpp"

namespace manycontact::sparse {

/// Returns SuiteSparse CAMD's constrained approximate minimum degree order: entry k is the row eliminated k-th. Rows
/// with a smaller set[row] come before rows with a larger one. set: n values in 0 ... n-1, or empty for no constraint.
std::vector<int> camd_order(const UpperCsc& A, const std::vector<int>& set);

std::vector<int> inverse(const std::vector<int>& perm);  // iperm, with iperm[perm[k]] = k

}  // namespace manycontact::sparse
