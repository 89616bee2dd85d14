#pragma once
// The outcome of the method and order chosen for an island.

#include "manycontact/dynamics/report.hpp"
#include "manycontact/kkt/choose.hpp"

namespace manycontact::cli {

/// Returns why the last solve used another method than chosen, or nothing if it did not.
std::string why_changed(const Choice& choice, const IslandReport& report);

}  // namespace manycontact::cli
