#pragma once
// The outcome of the method and order chosen for an island.

#include "manycontact/dynamics/report.hpp"
#include "manycontact/kkt/choose.hpp"

namespace manycontact::cli {

/// Returns why the last solve used another method than the chosen method; "" if it used the chosen method.
std::string why_changed(const Choice& choice, const IslandReport& report);

/// Returns the number of non-zeros of K, both triangles, without the contact rows' diagonal if it is zero.
double nonzeros_of_K(const IslandShape& shape, double damping);

}  // namespace manycontact::cli
