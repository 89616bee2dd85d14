#pragma once
// Relaxed supernodes: neighbouring columns of L with nearly the same pattern form a block, at the price of some zeros.
// Source: Ashcraft, Grimes, The influence of relaxed supernode partitions on the multifrontal method (1989).

#include "manycontact/sparse/ldl.hpp"

namespace manycontact::sparse {

/// Flags the columns that take the pattern of the next column, from the elimination tree and the columns' numbers of
/// off-diagonal entries. Blocks are extended from the root on as long as they remain full enough.
std::vector<char> nearly_nested(const std::vector<int>& parent, const std::vector<int>& counts);

void relax_supernodes(LdlSymbolic& L);
/// Relaxes L such that its leading columns have the entries of `leading`, which is relaxed already and belongs to the
/// leading rows and columns of the same matrix.
void relax_supernodes(const LdlSymbolic& leading, LdlSymbolic& L);

}  // namespace manycontact::sparse
