#pragma once
// Relaxed supernodes: neighbouring columns of L that have nearly one pattern are given one, so that they are worked on
// together, at the price of some entries that are zero. Source: Ashcraft, Grimes, The influence of relaxed supernode
// partitions on the multifrontal method (1989).

#include "manycontact/sparse/ldl.hpp"

namespace manycontact::sparse {

void relax_supernodes(LdlSymbolic& L);
/// The leading rows and columns of L's matrix are leading's, which is relaxed: L is relaxed to have the same entries
/// there.
void relax_supernodes(const LdlSymbolic& leading, LdlSymbolic& L);

}  // namespace manycontact::sparse
