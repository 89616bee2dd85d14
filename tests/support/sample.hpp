#pragma once
#include <algorithm>
#include <cstdlib>

namespace manycontact::test {

/// Returns n if sweeps test one of n cases: MANYCONTACT_SAMPLE, which `./run test` sets without --all; otherwise 1.
inline int sample() {
  const char* every = std::getenv("MANYCONTACT_SAMPLE");
  return every ? std::max(1, std::atoi(every)) : 1;
}

}  // namespace manycontact::test
