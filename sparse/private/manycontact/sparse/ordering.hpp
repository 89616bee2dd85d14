#pragma once
#include <vector>

#include "manycontact/sparse/upper_csc.hpp"

namespace manycontact::sparse {

/// Constrained approximate minimum degree (SuiteSparse CAMD): perm[k] is the row eliminated k-th; rows of a smaller
/// `set` come before rows of a larger one. set: n, values 0 ... n-1; empty: no constraint.
std::vector<int> camd_order(const UpperCsc& A, const std::vector<int>& set);

/// iperm with iperm[perm[k]] = k.
std::vector<int> inverse(const std::vector<int>& perm);

}  // namespace manycontact::sparse
