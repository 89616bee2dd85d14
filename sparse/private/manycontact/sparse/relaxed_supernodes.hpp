#pragma once
// Relaxed supernodes: neighbouring columns of L with nearly equal patterns form a block, in which L also stores zeros.
// Source: Ashcraft, Grimes, The influence of relaxed supernode partitions on the multifrontal method (1989).

#include "manycontact/sparse/ldl.hpp"

namespace manycontact::sparse {

/// Returns one flag per column: whether relaxation gives it the pattern of the next column. parent: elimination tree;
/// counts: numbers of off-diagonal entries of the columns. From the last column backwards, each block is extended as
/// long as it has few zeros.
std::vector<char> nearly_nested(const std::vector<int>& parent, const std::vector<int>& counts);

void relax_supernodes(LdlSymbolic& L);
/// Relaxes L such that its leading columns are those of `leading`, the relaxed analysis of the leading submatrix.
void relax_supernodes(const LdlSymbolic& leading, LdlSymbolic& L);

}  // namespace manycontact::sparse
