#include "manycontact/analysis/rounding.hpp"

namespace manycontact {

std::vector<std::string> Rounding::names() const {
  std::vector<std::string> out;
  if (acceleration) out.push_back("acceleration");
  if (forces) out.push_back("forces");
  return out;
}

Rounding find_rounding(const IslandReport& report) {
  if (report.status == Status::kFailed) return {};
  return {report.error_acceleration > 1, report.error_forces > 1};
}

Rounding find_rounding(const Report& report) {
  Rounding out;
  for (const IslandReport& island : report.islands) {
    const Rounding of_island = find_rounding(island);
    out.acceleration = out.acceleration || of_island.acceleration;
    out.forces = out.forces || of_island.forces;
  }
  return out;
}

}  // namespace manycontact
