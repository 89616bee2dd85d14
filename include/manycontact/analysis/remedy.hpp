#pragma once
// What to do about a solution that is not `ok`.

#include <string>

#include "manycontact/dynamics/report.hpp"

namespace manycontact {

/// Advice for an island's status and reason, in one or two sentences that name the function to call or the attribute to
/// set; empty for `ok`. Thread-safe.
std::string remedy(const IslandReport& report);

/// Advice for the worst island of a scene: that of its status, and of its reason if islands share the status.
std::string remedy(const Report& report);

}  // namespace manycontact
