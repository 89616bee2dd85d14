#pragma once
// Relaxed supernodes: neighbouring columns of L that have nearly one pattern are given one, so that they are worked on
// together, at the price of some entries that are zero. Source: Ashcraft, Grimes, The influence of relaxed supernode
// partitions on the multifrontal method (1989).

#include "manycontact/sparse/ldl.hpp"

namespace manycontact::sparse {

/// The columns that take the pattern of the next one, by the elimination tree and the columns' entries without their
/// diagonals: from the root, while the block that begins with it stays full enough.
std::vector<char> nearly_nested(const std::vector<int>& parent, const std::vector<int>& counts);

void relax_supernodes(LdlSymbolic& L);
/// The leading rows and columns of L's matrix are leading's, which is relaxed: L is relaxed to have the same entries
/// there.
void relax_supernodes(const LdlSymbolic& leading, LdlSymbolic& L);

}  // namespace manycontact::sparse
