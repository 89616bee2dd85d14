#pragma once
#include "results.hpp"

namespace manycontact::bench {

/// The ratios that claims are judged by: times of one run on one machine, divided. Those whose times are there.
void print_claims(const Run& run);

}  // namespace manycontact::bench
