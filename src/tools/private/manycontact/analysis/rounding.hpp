#pragma once

#include <string>
#include <vector>

#include "manycontact/dynamics/report.hpp"

namespace manycontact {

/// Which parts of a solution are rounding errors only, such as the accelerations of a scene at rest. The relative error
/// bound of such a part, from estimate_errors, is above 1.
struct Rounding {
  bool acceleration = false, forces = false;
  /// Names of the parts that are rounding errors: "acceleration", "forces".
  std::vector<std::string> names() const;
};

/// Tests the error bounds of an island. Before estimate_errors, and without a solution, both flags are false.
Rounding find_rounding(const IslandReport& report);

/// Tests the error bounds of all islands.
Rounding find_rounding(const Report& report);

}  // namespace manycontact
