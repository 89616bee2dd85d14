#pragma once
#include <vector>

#include "manycontact/sparse/upper_csc.hpp"

namespace manycontact::sparse {

/// Returns CAMD's order: entry k is the k-th row. Rows with a smaller set[row] come first; set: 0 ... n-1, or empty.
std::vector<int> camd_order(const UpperCsc& A, const std::vector<int>& set);

std::vector<int> inverse(const std::vector<int>& perm);  // iperm, with iperm[perm[k]] = k

}  // namespace manycontact::sparse
