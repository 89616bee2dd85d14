#pragma once

#include <string>

#include "manycontact/dynamics/report.hpp"

namespace manycontact {

/// Returns one or two sentences for an island's status and reason, which name the function to call or the attribute to
/// set; empty for `ok`. Thread-safe.
std::string remedy(const IslandReport& report);

/// Returns advice for the worst island: that of the scene's status, and of its reason if islands share the status.
std::string remedy(const Report& report);

}  // namespace manycontact
