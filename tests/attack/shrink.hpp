#pragma once

#include <cstdio>
#include <cstdlib>

#include "case.hpp"

namespace manycontact::attack {

/// Returns cases one step smaller: a contact or the last link fewer, a number zero or with one digit.
std::vector<Case> smaller_cases(const Case& c);

template <class Bad>
Case shrunk(Case c, Bad&& bad, int tries) {
  for (bool again = true; again && tries > 0;) {
    again = false;
    for (Case& smaller : smaller_cases(c)) {
      if (tries-- <= 0) break;
      if (!bad(smaller)) continue;
      c = std::move(smaller);
      again = true;
      break;
    }
  }
  return c;
}

}  // namespace manycontact::attack
