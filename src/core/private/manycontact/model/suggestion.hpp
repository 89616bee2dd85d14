#pragma once
// Wording of messages about unknown names, in files and in code.

#include <string>
#include <string_view>
#include <vector>

#include "manycontact/model/scene.hpp"

namespace manycontact {

/// Returns 'text' in quotes, shortened if long.
std::string quote(std::string_view text);

/// Returns "expected one of 'a', 'b', 'c'" for a few names, else "did you mean 'x'?".
std::string suggestion(const std::string& name, const std::vector<std::string>& known);

/// Explain why there is no such robot, frame of a robot, or movable joint: the kind of the name, or a suggestion.
std::string no_robot(const Scene& scene, const std::string& name);
std::string no_frame(const std::string& robot, const Model& model, const std::string& name);
std::string no_joint(const Model& model, const std::string& name);

/// Return the number of the robot or contact of that name; contact_at returns `number` if there is such a contact.
/// Throw std::invalid_argument with a suggestion, or naming `function`.
int robot_called(const Scene& scene, const std::string& name);
int contact_called(const Scene& scene, const std::string& name);
int contact_at(const Scene& scene, int number, const char* function);

}  // namespace manycontact
