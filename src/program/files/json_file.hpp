#pragma once

#include <Eigen/Core>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace manycontact::cli {

using Json = nlohmann::ordered_json;

/// Convert vectors to lists. Numbers that are not finite become null when they are written.
Json json_of(const Eigen::VectorXd& x);
Json json_of(const std::vector<Eigen::VectorXd>& list);

/// Writes JSON to the file of an option. "-" is standard output. Each member has its own line, so that long lists
/// remain readable. Doubles have the fewest digits that restore them. Throws InputError if the file cannot be written.
void write_json_file(const Json& json, const std::string& path, const std::string& option = "--json");

}  // namespace manycontact::cli
