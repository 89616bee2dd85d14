#pragma once
#include "results.hpp"

namespace manycontact::bench {

/// Prints the ratio of two times of the run for each claim, if both exist.
void print_claims(const Run& run);

}  // namespace manycontact::bench
