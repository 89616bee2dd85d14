#pragma once
// Texts about the method and order that were chosen for an island, and about those that solved it.

#include "manycontact/dynamics/report.hpp"
#include "manycontact/kkt/choose.hpp"

namespace manycontact::cli {

/// Returns why the last solve used another method than the chosen one, or "" if it used the chosen method.
std::string why_changed(const Choice& choice, const IslandReport& report);

/// Returns the number of nonzeros of K in both triangles. Contact rows have a diagonal entry only with damping.
double nonzeros_of_K(const IslandShape& shape, double damping);

}  // namespace manycontact::cli
