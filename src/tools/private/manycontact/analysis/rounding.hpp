#pragma once
// Numbers of a solution that are rounding errors only. Accelerations of a scene at rest are the rounding errors of
// terms that cancel. The bounds of estimate_errors, above 1 there, distinguish them from small numbers that are known.

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

/// Checks the solution of an island after estimate_errors. Before it, and without a solution, no number is marked.
Rounding find_rounding(const IslandReport& report);

/// The marks of any island: those that the largest errors of the report refer to.
Rounding find_rounding(const Report& report);

}  // namespace manycontact
