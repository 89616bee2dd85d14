#pragma once

#include <string>
#include <vector>

#include "manycontact/dynamics/report.hpp"

namespace manycontact {

/// Which parts of a solution are rounding errors only, such as the accelerations of a scene at rest: the relative error
/// bounds of estimate_errors are then above 1.
struct Rounding {
  bool acceleration = false, forces = false;
  /// Names of the parts that are rounding errors: "acceleration", "forces".
  std::vector<std::string> names() const;
};

/// Reads the error bounds of an island. Before estimate_errors, and without a solution, no part is marked.
Rounding find_rounding(const IslandReport& report);

/// Combines the marks of all islands.
Rounding find_rounding(const Report& report);

}  // namespace manycontact
