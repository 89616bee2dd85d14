#pragma once
#include <vector>

#include "manycontact/sparse/upper_csc.hpp"

namespace manycontact::sparse {

/// Constrained approximate minimum degree order (SuiteSparse CAMD): perm[k] is the row eliminated k-th. Rows with a
/// smaller `set` come before rows with a larger one. set: n values in 0 ... n-1; empty: no constraint.
std::vector<int> camd_order(const UpperCsc& A, const std::vector<int>& set);

/// The inverse permutation: iperm[perm[k]] = k.
std::vector<int> inverse(const std::vector<int>& perm);

}  // namespace manycontact::sparse
