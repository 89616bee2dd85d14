#pragma once
// Which numbers of an answer say nothing. Accelerations of a scene at rest are what rounding leaves of terms that
// cancel; the bounds of estimate_errors, above 1 there, tell them from small ones that are known.

#include <string>
#include <vector>

#include "manycontact/dynamics/report.hpp"

namespace manycontact {

/// Quantities of which nothing is known but that they are small.
struct Rounding {
  bool acceleration = false, forces = false;
  /// "acceleration", "forces": those that are.
  std::vector<std::string> names() const;
};

/// Of an island's answer. After estimate_errors: before it, and where there is no answer, nothing is.
Rounding find_rounding(const IslandReport& report);

/// Of at least one island's: those that the report's largest errors speak of.
Rounding find_rounding(const Report& report);

}  // namespace manycontact
