#pragma once

#include <string>
#include <vector>

#include "manycontact/dynamics/report.hpp"

namespace manycontact {

/// Flags of the parts of a solution that are only rounding errors, such as the accelerations of a scene at rest. The
/// relative error bound of such a part, from estimate_errors, is above 1.
struct Rounding {
  bool acceleration = false, forces = false;
  std::vector<std::string> names() const;  // parts that are only rounding errors: "acceleration", "forces"
};

/// Evaluates the error bounds of an island. Before estimate_errors, and without a solution, both flags are false.
Rounding find_rounding(const IslandReport& report);

Rounding find_rounding(const Report& report);

}  // namespace manycontact
