#pragma once
// Programs that stand beside this one.

#include <string>
#include <vector>

namespace manycontact::cli {

/// Becomes the program `name` in this program's folder, with `command` and `words` as its arguments. Returns only when
/// it is not there, or cannot be executed: throws std::runtime_error that says how to get it, `how`.
int run_beside(const std::string& name, const std::string& command, const std::vector<std::string>& words,
               const std::string& how);

}  // namespace manycontact::cli
