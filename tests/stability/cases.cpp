#include "stability/cases.hpp"

#include <cstdio>

namespace manycontact::test {

std::string power(double x) {
  char text[32];
  std::snprintf(text, sizeof text, "%.0e", x);
  return x == 0 ? "0" : text;
}

const std::vector<Cases>& all_causes() {
  static const std::vector<Cases> causes = [] {
    const std::pair<const char*, void (*)(Cases&)> list[] = {
        {"held twice", add_held_twice},
        {"corners of a foot", add_corners},
        {"loops with too few joints", add_loops},
        {"conflicting contacts", add_conflicts},
        {"contacts that nearly coincide", add_near},
        {"straight legs and arms", add_straight_legs},
        {"mass ratios", add_mass_ratios},
        {"massless links", add_singular_inertias},
        {"chains", add_chains},
        {"units", add_units},
        {"velocities", add_velocities},
        {"errors near half a turn", add_half_turns},
        {"denormal numbers", add_denormals},
        {"not finite", add_not_finite},
        {"damping", add_damping},
        {"quaternions off norm", add_quaternions},
    };
    std::vector<Cases> out;
    for (const auto& [cause, add] : list) {
      Cases& cases = out.emplace_back(Cases{cause, {}});
      add(cases);
    }
    return out;
  }();
  return causes;
}

}  // namespace manycontact::test
