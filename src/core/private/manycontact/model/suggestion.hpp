#pragma once
// Wording of messages about names that do not exist, in files and in code.

#include <string>
#include <string_view>
#include <vector>

#include "manycontact/model/scene.hpp"

namespace manycontact {

/// 'text', shortened when long.
std::string quote(std::string_view text);

/// "expected one of 'a', 'b', 'c'" for a few names, else "did you mean 'x'?", for a message about an unknown `name`.
std::string suggestion(const std::string& name, const std::vector<std::string>& known);

/// Why there is no such robot, frame (of the robot called `robot`) or joint that moves: the kind of the name, or a
/// suggestion.
std::string no_robot(const Scene& scene, const std::string& name);
std::string no_frame(const std::string& robot, const Model& model, const std::string& name);
std::string no_joint(const Model& model, const std::string& name);

/// The number of the robot or contact of that name; `number` itself where there is such a contact. Throw
/// std::invalid_argument with a suggestion, or in the name of `function`.
int robot_called(const Scene& scene, const std::string& name);
int contact_called(const Scene& scene, const std::string& name);
int contact_at(const Scene& scene, int number, const char* function);

}  // namespace manycontact
