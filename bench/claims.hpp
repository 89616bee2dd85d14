#pragma once
#include "results.hpp"

namespace manycontact::bench {

/// Prints the ratios of claims: times of one run on one machine, divided, if these times exist.
void print_claims(const Run& run);

}  // namespace manycontact::bench
