#pragma once

#include <string>

#include "manycontact/dynamics/report.hpp"

namespace manycontact {

/// Returns advice on an island's status and reason in one or two sentences: the function to call or the attribute to
/// set. Empty for `ok`. Thread-safe.
std::string remedy(const IslandReport& report);

/// Returns the advice for the first island that has the scene's status, the worst of all islands.
std::string remedy(const Report& report);

}  // namespace manycontact
